#include "camera_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.hpp"
#include "measurement/board_starts.hpp"
#include "measurement/camera_model.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::detail {
namespace {

struct SingleCampaign {
    Campaign campaign;
    Measurements measured;  ///< configurations of which this camera shows anything
};

/// One camera as if there were no others. Where a further one is follows from its views.
SingleCampaign single(const Campaign& campaign, const CameraSensor& cameras,
                      const Measurements& measured, Index c) {
    CameraSetup setup = cameras.setup();
    static_cast<SingleCamera&>(setup) = cameras.camera(c);
    setup.others.clear();
    if (c > 0 && setup.is_on_flange) setup.known_place.reset();
    SingleCampaign one{campaign, measured};
    const auto sensor = std::make_shared<CameraSensor>(std::move(setup));
    one.campaign.sensor = sensor;
    one.campaign.nominal.sensor =
        sensor->unknowns(cameras.place(campaign.nominal.sensor), cameras.camera(c).intrinsics);
    one.campaign.prior.reset();
    if (c > 0) {
        one.campaign.base_is_known.fill(false);
        one.campaign.has_nominal_base = one.campaign.has_nominal_targets = false;
    }
    const Index corners = cameras.corner_count();
    one.measured.observations = measured.observations.middleCols(2 * corners * c, 2 * corners);
    one.measured.is_seen = measured.is_seen.middleCols(corners * c, corners);
    std::vector<Index> shown;
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const Index first = measured.first_sample[static_cast<std::size_t>(i)];
        const auto of_pose = one.measured.is_seen.middleRows(first, measured.sample_count(i));
        if (of_pose.any()) shown.push_back(i);
    }
    one.measured = take(one.measured, shown);
    return one;
}

/// By how much the nominal robot misses half of what it sees, registered by itself; nothing where
/// it does not see enough for that.
std::optional<double> distance_of(const SingleCampaign& one) {
    try {
        const Registration found = register_base_and_targets(one.campaign, one.measured);
        if (!found.is_determined()) return std::nullopt;
        const RowMatrixXd left = mean_residuals(one.campaign, found.parameters, one.measured);
        return quantile(left.rowwise().norm(), 0.5, QuantileRule::Upper);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// Expected of each number of a sample, kpx^2.
VectorXd expected_variances(const Campaign& campaign, const Measurements& measured,
                            const Parameters& registered, Index sample) {
    const auto next = std::ranges::upper_bound(measured.first_sample, sample);
    const Index i = next - measured.first_sample.begin() - 1;
    const Isometry3d flange =
        world_from_flange(campaign, registered, measured.configurations.row(i).transpose());
    return campaign.sensor->covariance(flange, registered.sensor).diagonal();
}

}  // namespace

bool fits_no_pose(const Campaign& campaign, const Measurements& measured,
                  const Parameters& registered) {
    constexpr double far = 3;
    constexpr Index enough = 20;
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr || !detail::plane_of(camera->setup().corners) ||
        !camera->has_exact_corners()) {
        return false;
    }
    const Index corners = camera->corner_count();
    std::vector<double> left;
    for (const Index sample : evenly_spaced(measured.observations.rows(), enough)) {
        const VectorXd variances = expected_variances(campaign, measured, registered, sample);
        for (Index c = 0; c < camera->camera_count(); ++c) {
            const auto one = camera->left_by_any_pose(c, registered.sensor,
                                                      measured.observations.row(sample).transpose(),
                                                      measured.is_seen.row(sample));
            if (!one) continue;
            const SeenTargets seen = measured.is_seen.row(sample).segment(c * corners, corners);
            const VectorXd shown =
                variances.segment(2 * c * corners, 2 * corners)(seen_rows(seen, 2));
            left.push_back(kpx_per_px * *one / std::sqrt(shown.mean()));
        }
    }
    std::ranges::sort(left);
    return !left.empty() && left[left.size() / 2] > far;
}

std::optional<Misfit> find_camera_misfit(const Campaign& campaign, const Measurements& measured,
                                         const Misfit& misfit) {
    constexpr double far = 3;
    const auto* const cameras = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (cameras == nullptr || cameras->camera_count() == 1) return std::nullopt;
    std::vector<double> distances;
    for (Index c = 0; c < cameras->camera_count(); ++c) {
        const auto distance = distance_of(single(campaign, *cameras, measured, c));
        if (!distance) return std::nullopt;
        distances.push_back(*distance);
    }
    const auto worst = std::ranges::max_element(distances);
    const auto c = static_cast<std::size_t>(worst - distances.begin());
    double others = 0;
    for (std::size_t k = 0; k < distances.size(); ++k) {
        if (k != c) others = std::max(others, distances[k]);
    }
    Misfit found = misfit;
    if (*worst > far * others) {
        found.camera = static_cast<Index>(c);
        found.distance = *worst;
        found.others = others;
        return found;
    }
    if (!(misfit.distance > far * *worst)) return std::nullopt;
    found.is_between_cameras = true;
    found.others = *worst;
    return found;
}

}  // namespace posewise::detail
