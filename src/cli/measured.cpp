#include "measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/statistics.hpp"
#include "posewise/core/text.hpp"
#include "posewise/core/units.hpp"
#include "posewise/model/joint_limits.hpp"
#include "posewise/planner/prediction.hpp"
#include "suspicions.hpp"

namespace posewise::cli {
namespace {

/// Another robot's measurements are off by more than so many expected errors.
constexpr double credible_errors = 10;

/// RMS distance of points (n x 3) from their mean.
double extent(const RowMatrixXd& points) {
    return std::sqrt((points.rowwise() - points.colwise().mean()).rowwise().squaredNorm().mean());
}

/// How much farther the measured points of a target spread than the flange, by the joints, does.
double measured_extent(const Campaign& campaign, const Measurements& measured) {
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    RowMatrixXd flange(measured.configuration_count(), 3);
    for (Index i = 0; i < flange.rows(); ++i) {
        const VectorXd q = measured.configurations.row(i).transpose();
        flange.row(i) =
            campaign.robot.base_from_links(q, no_errors).back().translation().transpose();
    }
    RowMatrixXd seen(measured.is_seen.rows(), 3);
    Index count = 0;
    for (Index sample = 0; sample < seen.rows(); ++sample) {
        if (!measured.is_seen(sample, 0)) continue;
        seen.row(count++) = measured.observation(sample, 0);
    }
    return count > 0 ? extent(seen.topRows(count)) / extent(flange) : 1;
}

/// Of residuals as mean_residuals() gives them, the median: some may be grossly wrong.
double median_distance(const RowMatrixXd& residuals) {
    const auto coordinates = residuals.leftCols(std::min<Index>(3, residuals.cols()));
    return quantile(coordinates.rowwise().norm(), 0.5, QuantileRule::Upper);
}

/// Which unit is wrong by the look of it; empty if none is.
std::string suspect_unit(const Campaign& campaign, const Measurements& measured) {
    double largest = 0;
    for (Index j = 0; j < measured.configurations.cols(); ++j) {
        if (campaign.robot.joint(j).motion != Motion::Rotation) continue;
        largest = std::max(largest, measured.configurations.col(j).cwiseAbs().maxCoeff());
    }
    constexpr double turn = 2 * std::numbers::pi;
    if (largest > 2 * turn) return "; are joint values in degrees where the file says rad?";
    if (largest > 0 && largest < turn / 50) {
        return "; are joint values in rad where the file says degrees?";
    }
    if (measured.observations.cols() != 3 * measured.is_seen.cols()) return "";
    const double ratio = measured_extent(campaign, measured);
    if (ratio > 200 && ratio < 5000) return "; are points in mm where the file says m?";
    if (ratio > 1.0 / 5000 && ratio < 1.0 / 200) return "; are points in m where the file says mm?";
    return "";
}

}  // namespace

Measurements read_measured(const std::string& path, const io::CampaignFile& file) {
    Measurements measured = io::read_measurements(path, file);
    Index count = 0;
    std::string first;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const std::string violation =
            describe_limit_violation(file.robot, measured.configurations.row(i).transpose());
        if (violation.empty()) continue;
        if (++count == 1)
            first = quote(measured.ids[static_cast<std::size_t>(i)]) + ": " + violation;
    }
    if (count > 0) {
        print_warning(
            fmt::format("{}: {} of {} measured configurations are beyond the campaign's "
                        "joint limits, the first is {}",
                        path, count, measured.configuration_count(), first));
    }
    return measured;
}

std::string describe_misfit(const Campaign& campaign, const Measurements& measured) {
    Parameters fitted;
    try {
        fitted = register_base_and_targets(campaign, measured);
    } catch (const InputError&) {
        return "";  // too few to tell
    }
    const double error = median_distance(mean_residuals(campaign, fitted, measured));
    // At nominal targets: fitted to another robot's points they may be anywhere.
    const Blocks blocks =
        make_prediction_blocks(campaign, campaign.nominal, measured.configurations);
    const auto points = static_cast<double>(blocks.matrix.rows()) / 3;
    const double expected =
        std::sqrt(blocks.matrix
                      .middleCols(base_parameter_count(campaign), campaign.robot.parameter_count())
                      .squaredNorm() /
                  points) +
        campaign.model_error;
    if (error <= credible_errors * expected) return "";
    const std::string planes = suspect_planes(campaign, measured);
    return fmt::format(
        "are these of another robot? The nominal robot misses half of them by over {} mm; must be "
        "about {} mm, as the spread of {} says{}",
        format_short(mm_per_m * error, 3), format_short(mm_per_m * expected, 3), campaign.name,
        suspect_unit(campaign, measured) + (planes.empty() ? "" : "; " + planes));
}

void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const std::string& path) {
    const std::string misfit = describe_misfit(campaign, measured);
    if (!misfit.empty()) throw input_error_at({path}, misfit);
}

}  // namespace posewise::cli
