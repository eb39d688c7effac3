#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../calibrator/joint_signs.hpp"
#include "../core/format.hpp"
#include "../core/statistics.hpp"
#include "../core/text.hpp"
#include "expected_distance.hpp"
#include "other_senses.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/units.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

/// From here on joints that turn the other way are looked for: of a wrist they may do no more.
constexpr double doubtful_errors = 1;

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
        seen.row(count++) = measured.observation(sample, 0).head<3>();
    }
    return count > 0 ? detail::rms_spread(seen.topRows(count)) / detail::rms_spread(flange) : 1;
}

/// Of residuals as mean_residuals() gives them, the median: some may be grossly wrong.
double median_distance(const RowMatrixXd& residuals) {
    const auto coordinates = residuals.leftCols(std::min<Index>(3, residuals.cols()));
    return quantile(coordinates.rowwise().norm(), 0.5, detail::QuantileRule::Upper);
}

UnitDoubt find_unit_doubt(const Campaign& campaign, const Measurements& measured) {
    double largest = 0;
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {  // torques follow
        if (campaign.robot.joint(j).motion != Motion::Rotation) continue;
        largest = std::max(largest, measured.configurations.col(j).cwiseAbs().maxCoeff());
    }
    constexpr double turn = 2 * std::numbers::pi;
    if (largest > 2 * turn) return UnitDoubt::JointsInDegrees;
    if (largest > 0 && largest < turn / 50) return UnitDoubt::JointsInRadians;
    if (campaign.sensor->lengths_per_target() != 3) return UnitDoubt::None;
    const double ratio = measured_extent(campaign, measured);
    if (ratio > 200 && ratio < 5000) return UnitDoubt::PointsInMillimetres;
    if (ratio > 1.0 / 5000 && ratio < 1.0 / 200) return UnitDoubt::PointsInMetres;
    return UnitDoubt::None;
}

const char* ask_about(UnitDoubt unit) {
    switch (unit) {
        case UnitDoubt::None:
            break;
        case UnitDoubt::JointsInDegrees:
            return "; are joint values in degrees where the file says rad?";
        case UnitDoubt::JointsInRadians:
            return "; are joint values in rad where the file says degrees?";
        case UnitDoubt::PointsInMillimetres:
            return "; are points in mm where the file says m?";
        case UnitDoubt::PointsInMetres:
            return "; are points in m where the file says mm?";
    }
    return "";
}

std::string ask_about_directions(const Misfit& misfit) {
    if (misfit.reversed.empty()) return "";
    const std::string others =
        misfit.other_choices == 0
            ? ""
            : fmt::format(" (and as well by {})",
                          detail::count_of(misfit.other_choices, "other choice"));
    return fmt::format(
        "; do joints turn the other way than stated? They fit clearly better with {} reversed{}, "
        "see inspect --measurements",
        fmt::join(misfit.reversed, ", "), others);
}

std::string describe(const Plane& plane) {
    return fmt::format(
        "normal [{}, {}, {}] and offset {} mm", detail::format_fixed(plane.normal.x(), 3),
        detail::format_fixed(plane.normal.y(), 3), detail::format_fixed(plane.normal.z(), 3),
        detail::format_mm(plane.offset, 1));
}

/// "reversed", but where the normal points neither there nor where it is stated.
std::string describe_turn(const Vector3d& stated, const Vector3d& measured) {
    if (!detail::is_turned(stated, measured)) return "reversed";
    return fmt::format("turned by {} deg",
                       detail::format_short(to_degrees(std::acos(stated.dot(measured))), 2));
}

/// Adds those that fit clearly better the other way round; none where there are too many to try.
void find_reversed_joints(const Campaign& campaign, const Measurements& measured, Misfit& misfit) {
    if (campaign.robot.joint_count() > detail::most_signed_joints) return;
    const detail::JointSigns signs = detail::fit_joint_signs(campaign, measured);
    if (signs.patterns.empty() || !detail::has_clear_reversal(signs.patterns)) return;
    misfit.reversed = detail::reversed_joints(campaign.robot, signs.patterns.front());
    misfit.other_choices = detail::alike_count(signs.patterns) - 1;
}

}  // namespace

std::optional<Misfit> find_misfit(const Campaign& campaign, const Measurements& measured,
                                  const Parameters& registered) {
    if (!campaign.sensor->has_lengths()) return std::nullopt;  // of angles it is not known
    Misfit misfit;
    misfit.distance = median_distance(mean_residuals(campaign, registered, measured));
    misfit.expected = detail::expected_distance(campaign, measured);
    if (misfit.distance <= doubtful_errors * misfit.expected) return std::nullopt;
    misfit.unit = find_unit_doubt(campaign, measured);
    if (misfit.unit == UnitDoubt::None) find_reversed_joints(campaign, measured, misfit);
    const bool is_credible = misfit.distance <= detail::credible_errors * misfit.expected;
    if (is_credible && misfit.reversed.empty()) return std::nullopt;
    misfit.planes = find_plane_doubts(campaign, measured);
    if (!misfit.reversed.empty() && !misfit.planes.empty()) {
        // What takes fewer changes is more likely.
        if (misfit.reversed.size() <= misfit.planes.size()) {
            misfit.planes.clear();
        } else {
            misfit.reversed.clear();
        }
    }
    return misfit;
}

void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const Registration& registration) {
    if (!registration.is_determined()) return;
    const auto misfit = find_misfit(campaign, measured, registration.parameters);
    if (misfit) throw InputError(describe_misfit(campaign, *misfit));
    std::vector<PlaceDoubt> places = find_place_doubts(campaign, registration.parameters);
    std::erase_if(places, [](const auto& doubt) { return doubt.unit == PlaceDoubt::Unit::AsRead; });
    if (!places.empty()) throw InputError(describe_places(places));
}

std::string describe_planes(const std::vector<PlaneDoubt>& planes) {
    std::string text;
    for (const PlaneDoubt& doubt : planes) {
        text += fmt::format("{}plane {} looks {}: stated with {}, measured at about {}",
                            text.empty() ? "" : "; ", doubt.plane + 1,
                            describe_turn(doubt.stated.normal, doubt.measured.normal),
                            describe(doubt.stated), describe(doubt.measured));
    }
    return text;
}

std::string describe_misfit(const Campaign& campaign, const Misfit& misfit) {
    return fmt::format(
        "are these of another robot? The nominal robot misses half of them by over {} mm; must be "
        "about {} mm, as the spread of {} says{}{}{}{}",
        detail::format_short(mm_per_m * misfit.distance, 3),
        detail::format_short(mm_per_m * misfit.expected, 3), campaign.name, ask_about(misfit.unit),
        misfit.planes.empty() ? "" : "; ", describe_planes(misfit.planes),
        ask_about_directions(misfit));
}

}  // namespace posewise
