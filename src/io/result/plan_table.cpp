#include <unordered_set>

#include "core/text.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

bool has_ending(const std::string& path) {
    return path.ends_with(".csv") || path.ends_with(".CSV");
}

}  // namespace

Plan read_plan(const std::string& path, const Campaign& campaign) {
    if (!has_ending(path)) return read_plan(path);
    const Configurations read = read_program_csv(path, campaign);
    Plan plan;
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    std::unordered_set<std::string> ids;
    for (Index i = 0; i < read.joints.rows(); ++i) {
        const auto row = static_cast<std::size_t>(i);
        const std::string purpose = read.purposes.empty() ? "" : read.purposes[row];
        if (purpose == detail::on_the_way) continue;
        PlannedPose pose;
        pose.id = read.ids[row];
        pose.configuration = read.joints.row(i).transpose();
        pose.targets = targets_seen(read.is_seen.row(i));
        if (!ids.insert(pose.id).second) {
            throw input_error_at({path}, "has the configuration " + detail::quote(pose.id) +
                                             " twice; as a plan it must have each once");
        }
        (purpose == detail::to_verify ? plan.verification : plan.poses).push_back(std::move(pose));
    }
    plan.request.pose_count = std::ssize(plan.poses);
    return plan;
}

}  // namespace posewise::io
