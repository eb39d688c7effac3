#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "other_image.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise {
namespace {

double misfit_of(const Campaign& campaign, const Measurements& measured,
                 const Parameters& parameters) {
    return make_metrics(mean_residuals(campaign, parameters, measured), *campaign.sensor)
        .orientation_rms;
}

/// Whether the robot moved enough to tell how large the board is, and it is of another size.
void find_board_factor(const Campaign& campaign, const CameraSensor& camera,
                       const Measurements& measured, const Parameters& registered_as_stated,
                       CameraDoubt& doubt) {
    CameraSetup setup = camera.setup();
    if (setup.is_scale_unknown) return;
    setup.is_scale_unknown = true;
    Campaign open = campaign;
    const auto sensor = std::make_shared<CameraSensor>(setup);
    open.sensor = sensor;
    open.nominal.sensor.conservativeResize(open.nominal.sensor.size() + 1);
    open.nominal.sensor.tail<1>().setZero();
    open.prior.reset();
    open.spread.is_prior = true;  // whatever of its errors the poses do not tell
    const Registration registered = register_base_and_targets(open, measured);
    if (!registered.is_determined()) return;
    // The robot's own errors hide it before they are found.
    const Estimate scaled = identify(open, measured, registered.parameters);
    if (scaled.covariance.size() == 0) return;
    const double factor = sensor->board_factor(scaled.parameters.sensor);
    const double sigma = standard_deviations(scaled).tail<1>()[0];
    constexpr double clearly = 5;    // standard deviations
    constexpr double least = 0.004;  // lengths of robots are wrong by less
    if (!(factor > 0 && std::abs(factor - 1) > std::max(least, clearly * sigma))) return;
    Campaign as_stated = open;
    as_stated.sensor = campaign.sensor;
    as_stated.nominal = campaign.nominal;
    const Estimate stated = identify(as_stated, measured, registered_as_stated);
    const double misfit = misfit_of(campaign, measured, stated.parameters);
    const double scaled_misfit = misfit_of(open, measured, scaled.parameters);
    if (!(scaled_misfit < misfit)) return;  // something else is wrong
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

}  // namespace

std::optional<CameraDoubt> find_camera_doubt(const Campaign& campaign, const Measurements& measured,
                                             const Parameters& registered) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr) return std::nullopt;
    CameraDoubt doubt;
    find_board_factor(campaign, *camera, measured, registered, doubt);
    check_principal_point(*camera, measured, registered.sensor, doubt);
    for (Index c = 0; c < camera->camera_count() && !doubt.focal_lengths; ++c) {
        const Intrinsics found = camera->placed(c, registered.sensor).intrinsics;
        if (found.fx > 0 && found.fy > 0) continue;
        doubt.camera = c;
        doubt.focal_lengths = {found.fx, found.fy};
    }
    doubt.is_seen_from_back = is_seen_from_back(campaign, *camera, measured, registered);
    if (doubt.board_factor == 1 && !doubt.is_seen_from_back) {
        check_sigma(campaign, *camera, measured, registered, doubt);
    }
    if (doubt.board_factor == 1 && !doubt.principal_point && !doubt.focal_lengths &&
        !doubt.is_seen_from_back && doubt.scatter == 0) {
        return std::nullopt;
    }
    return doubt;
}

}  // namespace posewise
