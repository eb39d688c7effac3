#include <algorithm>
#include <cmath>

#include "calibrator/part_alone.hpp"
#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "other_image.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/doubts.hpp"
#include "task/calibration/expected_distance.hpp"

namespace posewise {
namespace {

double misfit_of(const Campaign& campaign, const Measurements& measured,
                 const Parameters& parameters) {
    return make_metrics(mean_residuals(campaign, parameters, measured), *campaign.sensor)
        .orientation_rms;
}

/// A campaign in which the size of a board is unknown, and which of the sensor's unknowns that is.
struct OpenSize {
    Campaign campaign;
    Index unknown = 0;
};

std::shared_ptr<const CameraSensor> with_unknown_size(const CameraSensor& camera) {
    CameraSetup setup = camera.setup();
    setup.is_scale_unknown = true;
    return std::make_shared<CameraSensor>(std::move(setup));
}

/// Its nominal unknowns, as many as stated, with that of the size.
VectorXd with_size_of_one(const VectorXd& unknowns) {
    VectorXd all(unknowns.size() + 1);
    all << unknowns, 0;
    return all;
}

OpenSize open_size(const Campaign& campaign, const CameraSensor& camera) {
    OpenSize open{campaign, campaign.nominal.sensor.size()};
    open.campaign.sensor = with_unknown_size(camera);
    open.campaign.nominal.sensor = with_size_of_one(campaign.nominal.sensor);
    return open;
}

/// Of one of several sensors, beside the others.
OpenSize open_size(const Campaign& campaign, const CombinedSensor& combined,
                   const CameraSensor& camera, Index opened) {
    std::vector<SensorPart> parts;
    std::vector<VectorXd> unknowns;
    std::vector<Isometry3d> frames;
    for (Index k = 0; k < combined.part_count(); ++k) {
        parts.push_back(combined.part(k));
        unknowns.push_back(combined.unknowns_of(k, campaign.nominal.sensor));
        frames.push_back(combined.frame(k, campaign.nominal.sensor));
    }
    const auto of_opened = static_cast<std::size_t>(opened);
    parts[of_opened].sensor = with_unknown_size(camera);
    unknowns[of_opened] = with_size_of_one(unknowns[of_opened]);
    OpenSize open{campaign};
    const auto sensor = std::make_shared<CombinedSensor>(std::move(parts));
    open.campaign.sensor = sensor;
    open.campaign.nominal.sensor = sensor->unknowns(unknowns, frames);
    // Where it is told from all others: 1 there, and 0 of all else.
    for (VectorXd& own : unknowns) own.setZero();
    const VectorXd none = sensor->unknowns(unknowns, frames);
    unknowns[of_opened].tail<1>()[0] = 1;
    (sensor->unknowns(unknowns, frames) - none).maxCoeff(&open.unknown);
    return open;
}

/// Whether the robot moved enough to tell how large the board is, and it is of another size.
void find_board_factor(const Campaign& campaign, const CameraSensor& camera, OpenSize open,
                       const Measurements& measured, const Parameters& registered_as_stated,
                       CameraDoubt& doubt) {
    const CameraSetup& setup = camera.setup();
    open.campaign.prior.reset();
    open.campaign.spread.is_prior = true;  // whatever of its errors the poses do not tell
    const Registration registered = register_base_and_targets(open.campaign, measured);
    if (!registered.is_determined()) return;
    // The robot's own errors hide it before they are found.
    const Estimate scaled = identify(open.campaign, measured, registered.parameters);
    if (scaled.covariance.size() == 0) return;
    const VectorXd sigmas = standard_deviations(scaled);
    const Index first = sigmas.size() - scaled.parameters.sensor.size();
    const double factor = 1 + scaled.parameters.sensor[open.unknown];
    const double sigma = sigmas[first + open.unknown];
    constexpr double clearly = 5;    // standard deviations
    constexpr double least = 0.004;  // lengths of robots are wrong by less
    if (!(factor > 0 && std::abs(factor - 1) > std::max(least, clearly * sigma))) return;
    Campaign as_stated = open.campaign;
    as_stated.sensor = campaign.sensor;
    as_stated.nominal = campaign.nominal;
    const Estimate stated = identify(as_stated, measured, registered_as_stated);
    // The search may end where it is worse than it began: its errors are far from any robot's.
    const double misfit = std::min(misfit_of(campaign, measured, stated.parameters),
                                   misfit_of(campaign, measured, registered_as_stated));
    const double scaled_misfit = misfit_of(open.campaign, measured, scaled.parameters);
    const double credible = detail::credible_distance(campaign, measured);
    if (!(scaled_misfit < misfit && scaled_misfit < credible)) return;  // something else is wrong
    doubt.misfit = misfit;
    doubt.scaled_misfit = scaled_misfit;
    doubt.board_factor = factor;
    const bool has_squares = setup.pattern.kind == BoardPattern::Kind::Chessboard ||
                             setup.pattern.kind == BoardPattern::Kind::Charuco;
    if (has_squares) doubt.square = (setup.corners[1] - setup.corners[0]).norm();
}

void check_principal_point(const CameraSensor& camera, const Measurements& measured,
                           const VectorXd& unknowns, CameraDoubt& doubt) {
    for (Index c = 0; c < camera.camera_count() && !doubt.principal_point; ++c) {
        const auto [middle, extents] = detail::image_of(camera, c, measured);
        const Intrinsics intrinsics = camera.placed(c, unknowns).intrinsics;
        const Vector2d off = Vector2d(intrinsics.cx, intrinsics.cy) - middle;
        constexpr double far = 0.25;
        if (!(off.cwiseQuotient(extents).cwiseAbs().maxCoeff() > far)) continue;
        doubt.camera = c;
        doubt.principal_point = {intrinsics.cx, intrinsics.cy};
        doubt.middle = {middle.x(), middle.y()};
        doubt.is_of_image = camera.camera(c).image.has_value();
    }
}

bool is_seen_from_back(const Campaign& campaign, const CameraSensor& camera,
                       const Measurements& measured, const Parameters& registered) {
    const RowMatrixXd seen = times_seen(measured);
    Index views = 0, backs = 0;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Isometry3d flange =
            world_from_flange(campaign, registered, measured.configurations.row(i).transpose());
        for (Index c = 0; c < camera.camera_count(); ++c) {
            const Index count = camera.corner_count();
            if (!(seen.row(i).segment(c * count, count).array() > 0).any()) continue;
            ++views;
            backs += camera.is_seen_from_back(c, flange, registered.sensor) ? 1 : 0;
        }
    }
    return 2 * backs > views;
}

/// What no pose of the board explains, per number left over, in standard deviations as stated: the
/// median view's. However the robot errs, it does not depend on it.
double scatter_about_poses(const Campaign& campaign, const Measurements& measured,
                           const Parameters& registered) {
    const Sensor& sensor = *campaign.sensor;
    const TwistMatrix twists = TwistMatrix::Identity(6, 6);
    std::vector<double> variances;
    RowMatrixXd J(sensor.row_count(), twists.cols());
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Isometry3d flange =
            world_from_flange(campaign, registered, measured.configurations.row(i).transpose());
        const VectorXd sigmas = sensor.covariance(flange, registered.sensor).diagonal().cwiseSqrt();
        sensor.differentiate(flange, twists, registered.sensor, J);
        J = sigmas.cwiseInverse().asDiagonal() * J;
        const VectorXd predicted = sensor.predict(flange, registered.sensor);
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        for (Index sample = first; sample < first + measured.sample_count(i); ++sample) {
            const std::vector<Index> rows = seen_rows(measured.is_seen.row(sample), 2);
            const Index left = std::ssize(rows) - twists.cols();
            if (left < 2) continue;
            const MatrixXd A = J(rows, Eigen::all);
            const VectorXd r = (measured.observations.row(sample).transpose() - predicted)
                                   .cwiseQuotient(sigmas)(rows);
            const VectorXd unexplained = r - A * detail::PivotedReflections(A).solve(r);
            variances.push_back(unexplained.squaredNorm() / static_cast<double>(left));
        }
    }
    if (variances.empty()) return 0;
    const Eigen::Map<const VectorXd> all(variances.data(), std::ssize(variances));
    return std::sqrt(detail::quantile(all, 0.5, detail::QuantileRule::Upper));
}

void check_sigma(const Campaign& campaign, const CameraSensor& camera, const Measurements& measured,
                 const Parameters& registered, CameraDoubt& doubt) {
    constexpr double plainly = 1.5;
    constexpr Index enough = 8;  // views
    if (measured.configuration_count() < enough) return;
    const double times = scatter_about_poses(campaign, measured, registered);
    if (!(times > plainly || (times > 0 && times < 1 / plainly))) return;
    doubt.sigma = camera.setup().sigma;
    doubt.scatter = times * doubt.sigma;
}

/// The size of a board beside others that the same camera sees is told by these, too: alone it
/// hides in the robot, of which one board may show little.
void find_board_factor(const Campaign& campaign, const Measurements& measured,
                       const Parameters& registered, const detail::PartAlone& alone,
                       const CameraSensor& camera, CameraDoubt& doubt) {
    if (camera.setup().is_scale_unknown) return;
    const auto* const combined = dynamic_cast<const CombinedSensor*>(campaign.sensor.get());
    if (combined == nullptr || !combined->part(alone.part).same_camera) {
        return find_board_factor(alone.campaign, camera, open_size(alone.campaign, camera),
                                 alone.measured, alone.registered, doubt);
    }
    find_board_factor(campaign, camera, open_size(campaign, *combined, camera, alone.part),
                      measured, registered, doubt);
}

/// Stated ones that are to be found tell only roughly where to begin, and poses are planned by
/// them.
void check_focal_lengths(const CameraSensor& camera, Index c, const VectorXd& unknowns,
                         CameraDoubt& doubt) {
    constexpr double far = 1.5;
    const Intrinsics& stated = camera.camera(c).intrinsics;
    const Intrinsics found = camera.placed(c, unknowns).intrinsics;
    const auto is_far = [](double one, double other) {
        return other > 0 && (one > far * other || other > far * one);
    };
    const bool is_negative = !(found.fx > 0 && found.fy > 0);
    if (!is_negative && !is_far(found.fx, stated.fx) && !is_far(found.fy, stated.fy)) return;
    doubt.camera = c;
    doubt.focal_lengths = {found.fx, found.fy};
    if (!is_negative) doubt.stated_focal_lengths = {stated.fx, stated.fy};
}

/// Of what is not about the size of the board.
void check_others(const detail::PartAlone& alone, const CameraSensor& camera, CameraDoubt& doubt) {
    const VectorXd& unknowns = alone.registered.sensor;
    check_principal_point(camera, alone.measured, unknowns, doubt);
    for (Index c = 0; c < camera.camera_count() && !doubt.focal_lengths; ++c) {
        check_focal_lengths(camera, c, unknowns, doubt);
    }
    doubt.is_seen_from_back =
        is_seen_from_back(alone.campaign, camera, alone.measured, alone.registered);
    if (doubt.board_factor == 1 && !doubt.is_seen_from_back) {
        check_sigma(alone.campaign, camera, alone.measured, alone.registered, doubt);
    }
}

bool is_any(const CameraDoubt& doubt) {
    return doubt.board_factor != 1 || doubt.principal_point || doubt.focal_lengths ||
           doubt.is_seen_from_back || doubt.scatter > 0;
}

}  // namespace

std::optional<CameraDoubt> find_camera_doubt(const Campaign& campaign, const Measurements& measured,
                                             const Parameters& registered) {
    std::optional<CameraDoubt> first;
    for (const auto& alone : detail::parts_alone(campaign, measured, registered)) {
        const auto* const camera = dynamic_cast<const CameraSensor*>(alone.campaign.sensor.get());
        if (camera == nullptr) continue;
        CameraDoubt doubt;
        if (campaign.sensor->is_combined()) doubt.sensor = alone.part + 1;
        find_board_factor(campaign, measured, registered, alone, *camera, doubt);
        check_others(alone, *camera, doubt);
        // A board of another size makes all that one sees doubtful, whichever it is.
        if (doubt.board_factor != 1) return doubt;
        if (is_any(doubt) && !first) first = doubt;
    }
    return first;
}

}  // namespace posewise
