#include "inputs.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "measurement/noise.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::detail {

std::vector<std::string> number_ids(Index count) {
    std::vector<std::string> ids;
    for (Index i = 0; i < count; ++i) ids.push_back(std::to_string(i));
    return ids;
}

Blocks measured_blocks(const Campaign& campaign, const Parameters& parameters,
                       const Measurements& measured) {
    return make_blocks(campaign, parameters, measured.configurations,
                       RowMatrixXd(mean_repeats(measured) * share_seen(measured)));
}

RowMatrixXd turning_joints(const Chain& robot, const RowMatrixXd& configurations) {
    std::vector<Index> turning;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        if (robot.joint(j).motion == Motion::Rotation) turning.push_back(j);
    }
    return configurations(Eigen::all, turning);
}

bool can_assume_places(const Campaign& campaign) {
    // What is to be touched has to be where it is said to be.
    if (campaign.sensor->has_contacts()) return false;
    // A model error that moves the flange is alike in all directions.
    Campaign without = campaign;
    without.model_error_common = 0;
    return campaign.has_nominal_base ||
           (campaign.sensor->lengths_per_target() == 3 && !campaign.sensor->is_combined() &&
            has_constant_noise(without));
}

InputError unstated_contacts(const Campaign& campaign) {
    return InputError(campaign.name +
                      ": the campaign file does not say where the ball and all that it is to touch "
                      "are; must state it, if only roughly (position_mm of sensor.targets and of "
                      "each of sensor.sockets, base where those are known), or an estimate "
                      "(`earlier`) or measured poses must tell it");
}

Parameters register_measured(const Campaign& campaign, const Measurements& measured,
                             const std::string& name) {
    return compute_from(name, [&] {
        Registration registration = register_base_and_targets(campaign, measured);
        check_is_of_robot(campaign, measured, registration);
        return determined(std::move(registration));
    });
}

void check_measured(const Campaign& campaign, const Measurements& measured,
                    const std::string& name) {
    compute_from(name, [&] {
        check_is_of_robot(campaign, measured, register_base_and_targets(campaign, measured));
    });
}

void check_torques_known(const Campaign& campaign) {
    if (campaign.robot.torques().empty()) return;
    throw InputError(campaign.name +
                     ": its torques are measured with each configuration, and of poses that are "
                     "drawn nobody knows them; state robot.compliance.links and payload instead of "
                     "torques_Nm");
}

void check_memory(const Campaign& campaign, Index count, const std::string& field) {
    constexpr double bytes_per_gb = 1e9;
    constexpr double beside = 1.25;  // what a search needs beside the blocks
    const double needed = beside * static_cast<double>(sizeof(double)) *
                          static_cast<double>(count) *
                          static_cast<double>(campaign.sensor->row_count()) *
                          static_cast<double>(parameter_count(campaign));
    rlimit limit{};
    getrlimit(RLIMIT_AS, &limit);
    const double there = std::min(
        static_cast<double>(limit.rlim_cur),
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE)));
    if (needed < there) return;
    throw InputError(
        fmt::format("{} candidates need {:.0f} GB of memory, there are {:.0f} GB; lower `{}`",
                    count, needed / bytes_per_gb, there / bytes_per_gb, field));
}

void check_enough_poses(const Campaign& campaign, Index count, Index measured,
                        const StopSignal& stop) {
    const Index least = least_calibration_count(campaign, stop) - measured;
    if (count >= least) return;
    if (campaign.fitted_pose_count > 0) {
        throw InputError(fmt::format(
            "`pose_count` is {}, must be at least {}: fewer do not identify the errors that "
            "calibrate fits, robot.errors",
            count, least));
    }
    throw InputError(
        campaign.spread.is_prior
            ? fmt::format(
                  "`pose_count` is {}, must be at least {}: fewer are not enough to register "
                  "{}{}, which {} no prior",
                  count, least, base_parameter_count(campaign) > 0 ? "base and " : "",
                  campaign.sensor->words().place,
                  base_parameter_count(campaign) > 0 ? "have" : "has")
            : fmt::format("`pose_count` is {}, must be at least {}: fewer do not identify {} "
                          "parameters; or let a prior (`spread.is_prior`) tell the rest",
                          count, least, parameter_count(campaign)));
}

}  // namespace posewise::detail
