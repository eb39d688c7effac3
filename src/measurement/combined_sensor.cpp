#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <utility>

#include "camera_view.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

constexpr Index of_frame = 6;  // position and rotation vector

/// A motion of the world's bodies as another frame has it.
TwistMatrix as_seen_from(const Isometry3d& frame_from_world, const TwistMatrix& twists) {
    TwistMatrix seen(6, twists.cols());
    seen.topRows<3>() = frame_from_world.linear() * twists.topRows<3>();
    seen.bottomRows<3>() = frame_from_world.linear() * twists.bottomRows<3>() +
                           cross_matrix(frame_from_world.translation()) * seen.topRows<3>();
    return seen;
}

/// Names of what is unknown of a camera, rather than of the board that it sees.
std::vector<std::string> of_camera(const Sensor& sensor) {
    std::vector<std::string> names = sensor.unknown_names();
    std::erase_if(names, [](const std::string& name) { return !name.starts_with("camera"); });
    return names;
}

/// The camera that a part shares with one before it; nothing: it has its own.
const CameraSensor* shared_camera(const std::vector<SensorPart>& parts, std::size_t part) {
    const auto& same = parts[part].same_camera;
    if (!same) return nullptr;
    const auto as_camera = [&](std::size_t k) {
        return dynamic_cast<const CameraSensor*>(parts[k].sensor.get());
    };
    const bool is_before = *same >= 0 && *same < static_cast<Index>(part);
    const auto* const first = is_before ? as_camera(static_cast<std::size_t>(*same)) : nullptr;
    const auto* const own = as_camera(part);
    if (first == nullptr || own == nullptr) {
        throw InputError("the same camera must be that of a sensor before, of kind camera");
    }
    const bool is_alike = first->setup().is_on_flange == own->setup().is_on_flange &&
                          of_camera(*first) == of_camera(*own);
    if (!is_alike) throw InputError("what is unknown of the same camera must be the same");
    return first;
}

void check_parts(const std::vector<SensorPart>& parts) {
    if (parts.size() < 2) throw InputError("a combination needs two sensors or more");
    bool has_pixels = false;
    bool has_angles = false;
    for (const SensorPart& part : parts) {
        const auto& sensor = part.sensor;
        const auto& frame = part.known_frame;
        if (sensor->is_combined()) throw InputError("a combined sensor cannot be combined again");
        if (sensor->has_contacts()) {
            throw InputError(
                "sockets cannot be combined with other sensors; state their places as known to "
                "another sensor, or calibrate by sockets alone");
        }
        if (records_inverse(*sensor)) {
            throw InputError(
                "poses of a board that a camera on the flange records cannot be combined with "
                "other sensors; state the corners that it sees (kind: camera)");
        }
        has_pixels = has_pixels || sensor->has_pixels();
        has_angles = has_angles || (sensor->has_angles() && !sensor->has_pixels());
        if (frame && !frame->matrix().allFinite()) {
            throw InputError("the frame of a sensor has a value that is not a finite number");
        }
    }
    if (has_pixels && has_angles) {
        throw InputError(
            "a camera cannot be combined with poses; state points of the tool instead of its "
            "poses");
    }
    const auto& first = parts.front().known_frame;
    if (!first || !first->isApprox(Isometry3d::Identity(), 1e-12)) {
        throw InputError("the first sensor's frame is the world; nothing else may be stated of it");
    }
}

Index angles_of(const Sensor& sensor) {
    return sensor.rows_per_target() - sensor.lengths_per_target();
}

/// How many unknowns of known size a part has that are not those of a camera it shares.
Index own_size_count(const std::vector<SensorPart>& parts, std::size_t part) {
    const Sensor& sensor = *parts[part].sensor;
    auto names = sensor.unknown_names();
    names.resize(static_cast<std::size_t>(sensor.unknown_sizes().size()));
    if (shared_camera(parts, part) == nullptr) return std::ssize(names);
    return std::ranges::count_if(
        names, [](const std::string& name) { return !name.starts_with("camera"); });
}

/// Whether what a part has on the flange is a camera that it shares.
bool shares_targets(const std::vector<SensorPart>& parts, std::size_t part) {
    const CameraSensor* const camera = shared_camera(parts, part);
    return camera != nullptr && camera->setup().is_on_flange;
}

/// Of all parts, the unknowns of each in the combination's order: those with sizes, then of
/// targets, then the others.
Targets all_targets(const std::vector<SensorPart>& parts) {
    std::vector<Vector3d> positions;
    std::vector<std::array<bool, 3>> is_known;
    Index sizes = 0;
    for (std::size_t part = 0; part < parts.size(); ++part) {
        const Sensor& sensor = *parts[part].sensor;
        const Targets& targets = sensor.targets();
        const VectorXd zero = VectorXd::Zero(static_cast<Index>(sensor.unknown_names().size()));
        sizes += own_size_count(parts, part);
        if (shares_targets(parts, part)) continue;
        for (Index j = 0; j < targets.count(); ++j) {
            positions.push_back(targets.position(j, zero));
            is_known.push_back({targets.unknown_index(j, 0) < 0, targets.unknown_index(j, 1) < 0,
                                targets.unknown_index(j, 2) < 0});
        }
    }
    return Targets(std::move(positions), std::move(is_known), sizes);
}

/// Puts `names` into those that are taken, but for those not to be; false: some are already.
bool take_names(const std::vector<std::string>& names, std::set<std::string>& taken,
                const std::vector<bool>& is_left = {}) {
    std::set<std::string> own;
    for (std::size_t k = 0; k < names.size(); ++k) {
        if (is_left.empty() || !is_left[k]) own.insert(names[k]);
    }
    const bool are_new =
        std::ranges::none_of(own, [&](const std::string& name) { return taken.contains(name); });
    if (are_new) taken.merge(own);
    return are_new;
}

std::vector<std::string> with_prefix(const std::string& prefix, std::vector<std::string> names) {
    for (std::string& name : names) name = prefix + name;
    return names;
}

/// "sensor.targets.known" of the second one: "sensors[2].targets.known".
std::string key_of(const std::string& key, std::size_t part) {
    constexpr std::string_view alone = "sensor.";
    if (!key.starts_with(alone)) return key;
    return fmt::format("sensors[{}].{}", part + 1, key.substr(alone.size()));
}

}  // namespace

CombinedSensor::CombinedSensor(std::vector<SensorPart> parts)
    : targets_((check_parts(parts), all_targets(parts))) {
    Index next_size = 0;
    Index next_target = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) next_target += own_size_count(parts, k);
    Index next = next_target + targets_.unknown_count();
    Index points = 0;
    std::set<std::string> rows_taken;
    std::set<std::string> unknowns_taken;
    first_rows_.push_back(0);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const Sensor& sensor = *parts[k].sensor;
        Part part{parts[k], row_count_, target_count(), points, sensor.lengths_per_target()};
        const Part* const shared = shared_camera(parts, k) ? &of(*parts[k].same_camera) : nullptr;
        const auto names = sensor.unknown_names();
        const Index sizes = sensor.unknown_sizes().size();
        const Index of_targets = sensor.targets().unknown_count();
        for (std::size_t i = 0; i < names.size(); ++i) {
            const auto unknown = static_cast<Index>(i);
            part.is_shared.push_back(shared != nullptr && names[i].starts_with("camera"));
            if (part.is_shared.back()) {
                const auto of_shared = shared->sensor().unknown_names();
                const auto same = std::ranges::find(of_shared, names[i]) - of_shared.begin();
                part.unknowns.push_back(shared->unknowns[static_cast<std::size_t>(same)]);
                continue;
            }
            Index& place = unknown < sizes                ? next_size
                           : unknown < sizes + of_targets ? next_target
                                                          : next;
            part.unknowns.push_back(place++);
        }
        part.has_own_rows = take_names(sensor.observation_names(), rows_taken);
        part.has_own_unknowns = take_names(names, unknowns_taken, part.is_shared);
        for (Index target = 0; target < sensor.target_count(); ++target) {
            first_rows_.push_back(row_count_ + sensor.first_row(target + 1));
        }
        row_count_ += sensor.row_count();
        if (shares_targets(parts, k)) {
            part.first_point = shared->first_point;
        } else {
            points += sensor.targets().count();
        }
        lengths_ = std::max(lengths_, part.lengths);
        angles_ = std::max(angles_, angles_of(sensor));
        parts_.push_back(std::move(part));
    }
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        Part& part = parts_[k];
        if (part.stated.same_camera && !shares_targets(parts, k)) {  // the camera's own frame
            const Part& same = of(*part.stated.same_camera);
            part.frame = same.frame;
            part.stated.known_frame = same.stated.known_frame;
            continue;
        }
        if (part.stated.known_frame) continue;
        part.frame = next;
        next += of_frame;
    }
    unknown_count_ = next;
}

Index CombinedSensor::part_of(Index target) const {
    Index part = part_count() - 1;
    while (of(part).first_target > target) --part;
    return part;
}

const CombinedSensor::Part& CombinedSensor::of_row(Index row) const {
    Index part = part_count() - 1;
    while (of(part).first_row > row) --part;
    return of(part);
}

Index CombinedSensor::target_of(Index row) const {
    const Part& part = of_row(row);
    return part.first_target + part.sensor().target_of(row - part.first_row);
}

Index CombinedSensor::column_of(Index row) const {
    const Part& part = of_row(row);
    const Index column = part.sensor().column_of(row - part.first_row);
    return column < part.lengths ? column : lengths_ + column - part.lengths;
}

Index CombinedSensor::point_of(Index target) const {
    const Part& part = of(part_of(target));
    return part.first_point + part.sensor().point_of(target - part.first_target);
}

bool CombinedSensor::is_angle(Index row) const {
    const Part& part = of_row(row);
    return part.sensor().is_angle(row - part.first_row);
}

bool CombinedSensor::is_distance(Index row) const {
    const Part& part = of_row(row);
    return part.sensor().is_distance(row - part.first_row);
}

bool CombinedSensor::has_pixels() const {
    return std::ranges::any_of(parts_, [](const Part& part) { return part.sensor().has_pixels(); });
}

std::optional<double> CombinedSensor::target_radius() const {
    std::optional<double> largest;
    for (const Part& part : parts_) {
        const auto radius = part.sensor().target_radius();
        if (radius && *radius > largest.value_or(0)) largest = radius;
    }
    return largest;
}

bool CombinedSensor::has_only_shared_unknowns(Index part) const {
    return std::ranges::all_of(of(part).is_shared, std::identity());
}

VectorXd CombinedSensor::unknowns_of(Index part, const VectorXd& unknowns) const {
    return unknowns(of(part).unknowns);
}

VectorXd CombinedSensor::unknowns(const std::vector<VectorXd>& of_parts,
                                  const std::vector<Isometry3d>& frames) const {
    VectorXd all(unknown_count_);
    for (std::size_t k = parts_.size(); k-- > 0;) {  // what parts share is the first one's
        all(parts_[k].unknowns) = of_parts[k];
        if (parts_[k].frame >= 0) all.segment<of_frame>(parts_[k].frame) = tool_unknowns(frames[k]);
    }
    return all;
}

Parameters CombinedSensor::parameters_of(Index part, const Parameters& all) const {
    return {part_from_first(of(part), all.sensor) * all.world_from_base, all.robot,
            unknowns_of(part, all.sensor)};
}

Isometry3d CombinedSensor::frame(Index part, const VectorXd& unknowns) const {
    return frame_of(of(part), unknowns);
}

Isometry3d CombinedSensor::frame_of(const Part& part, const VectorXd& unknowns) const {
    if (part.frame < 0) return *part.stated.known_frame;
    return detail::frame_from(unknowns.segment<of_frame>(part.frame));
}

// With R, p where the part's frame is in the first one's, a point is at y = R^T (x - p). A step dp
// moves it by -R^T dp; a turn of R by w, by -R^T w cross y.
TwistMatrix CombinedSensor::frame_twists(const Part& part, const VectorXd& unknowns) const {
    if (part.frame < 0) return TwistMatrix(6, 0);
    const Vector3d turn = unknowns.segment<3>(part.frame + 3);
    const Matrix3d inverse = rotation_from_vector(turn).transpose();
    TwistMatrix twists = TwistMatrix::Zero(6, of_frame);
    twists.bottomLeftCorner<3, 3>() = -inverse;
    twists.topRightCorner<3, 3>() = -inverse * rotation_vector_rate(turn);
    return twists;
}

void CombinedSensor::take_in(const Part& part, const RowMatrixXd& J, Index twists,
                             Eigen::Ref<RowMatrixXd> J_all) const {
    auto rows = J_all.middleRows(part.first_row, J.rows());
    rows.leftCols(twists) = J.leftCols(twists);
    if (J_all.cols() == twists) return;
    auto own = rows.rightCols(unknown_count_);
    own.setZero();
    Index next = twists;
    for (Index k = 0; part.frame >= 0 && k < of_frame; ++k) own.col(part.frame + k) = J.col(next++);
    for (const Index k : part.unknowns) own.col(k) = J.col(next++);
}

void CombinedSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                             Eigen::Ref<VectorXd> observation) const {
    for (const Part& part : parts_) {
        part.sensor().predict(part_from_first(part, unknowns) * world_from_flange,
                              unknowns(part.unknowns),
                              observation.segment(part.first_row, part.sensor().row_count()));
    }
}

TwistMatrix CombinedSensor::part_twists(const Part& part, const Isometry3d& part_from_first,
                                        const TwistMatrix& twists, bool has_unknowns,
                                        const VectorXd& unknowns) const {
    const TwistMatrix by_frame = has_unknowns ? frame_twists(part, unknowns) : TwistMatrix(6, 0);
    TwistMatrix all(6, twists.cols() + by_frame.cols());
    all << as_seen_from(part_from_first, twists), by_frame;
    return all;
}

void CombinedSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                   const VectorXd& unknowns,
                                   Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    const bool has_unknowns = J_measured_parameters.cols() > twists.cols();
    for (const Part& part : parts_) {
        const Isometry3d from_first = part_from_first(part, unknowns);
        const TwistMatrix all = part_twists(part, from_first, twists, has_unknowns, unknowns);
        const Index own = has_unknowns ? std::ssize(part.unknowns) : 0;
        RowMatrixXd J(part.sensor().row_count(), all.cols() + own);
        part.sensor().differentiate(from_first * world_from_flange, all, unknowns(part.unknowns),
                                    J);
        take_in(part, J, twists.cols(), J_measured_parameters);
    }
}

void CombinedSensor::differentiate_along(const Isometry3d& world_from_flange,
                                         const TwistMatrix& twists, const Twist& direction,
                                         const TwistMatrix& twist_rates, const VectorXd& unknowns,
                                         Eigen::Ref<RowMatrixXd> J_rate) const {
    const bool has_unknowns = J_rate.cols() > twists.cols();
    for (const Part& part : parts_) {
        const Isometry3d from_first = part_from_first(part, unknowns);
        const TwistMatrix all = part_twists(part, from_first, twists, has_unknowns, unknowns);
        TwistMatrix rates = TwistMatrix::Zero(6, all.cols());
        rates.leftCols(twists.cols()) = as_seen_from(from_first, twist_rates);
        const Index own = has_unknowns ? std::ssize(part.unknowns) : 0;
        RowMatrixXd J(part.sensor().row_count(), all.cols() + own);
        part.sensor().differentiate_along(from_first * world_from_flange, all,
                                          as_seen_from(from_first, direction), rates,
                                          unknowns(part.unknowns), J);
        take_in(part, J, twists.cols(), J_rate);
    }
}

void CombinedSensor::covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                                Eigen::Ref<MatrixXd> covariance) const {
    covariance.setZero();
    for (const Part& part : parts_) {
        const Index rows = part.sensor().row_count();
        part.sensor().covariance(part_from_first(part, unknowns) * world_from_flange,
                                 unknowns(part.unknowns),
                                 covariance.block(part.first_row, part.first_row, rows, rows));
    }
}

MatrixXd CombinedSensor::covariance_rate(const Isometry3d& world_from_flange,
                                         const Twist& direction, const VectorXd& unknowns) const {
    MatrixXd rate = MatrixXd::Zero(row_count_, row_count_);
    for (const Part& part : parts_) {
        if (part.sensor().has_constant_covariance()) continue;
        const Isometry3d from_first = part_from_first(part, unknowns);
        const Index rows = part.sensor().row_count();
        rate.block(part.first_row, part.first_row, rows, rows) = part.sensor().covariance_rate(
            from_first * world_from_flange, as_seen_from(from_first, direction),
            unknowns(part.unknowns));
    }
    return rate;
}

bool CombinedSensor::has_constant_covariance() const {
    return std::ranges::all_of(
        parts_, [](const Part& part) { return part.sensor().has_constant_covariance(); });
}

void CombinedSensor::deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                               Eigen::Ref<VectorXd> deviation) const {
    for (const Part& part : parts_) {
        const Index rows = part.sensor().row_count();
        part.sensor().deviation(observation.segment(part.first_row, rows),
                                reference.segment(part.first_row, rows),
                                deviation.segment(part.first_row, rows));
    }
}

void CombinedSensor::deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                             Eigen::Ref<VectorXd> observation) const {
    for (const Part& part : parts_) {
        const Index rows = part.sensor().row_count();
        part.sensor().deviate(reference.segment(part.first_row, rows),
                              deviation.segment(part.first_row, rows),
                              observation.segment(part.first_row, rows));
    }
}

bool CombinedSensor::has_view() const {
    return std::ranges::any_of(parts_, [](const Part& part) { return part.sensor().has_view(); });
}

bool CombinedSensor::is_readable(Index target, const ConstNumbers& observation) const {
    const Part& part = of(part_of(target));
    return part.sensor().is_readable(
        target - part.first_target, observation.segment(part.first_row, part.sensor().row_count()));
}

void CombinedSensor::view_clearances(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                                     Eigen::Ref<VectorXd> clearances) const {
    constexpr double always = std::numbers::pi;
    for (const Part& part : parts_) {
        auto own = clearances.segment(part.first_target, part.sensor().target_count());
        if (!part.sensor().has_view()) {
            own.setConstant(always);
            continue;
        }
        part.sensor().view_clearances(part_from_first(part, unknowns) * world_from_flange,
                                      unknowns(part.unknowns), own);
    }
    hide_incomplete_parts(clearances);
}

void CombinedSensor::hide_incomplete_parts(Eigen::Ref<VectorXd> clearances) const {
    for (const Part& part : parts_) {
        if (!part.sensor().has_view()) continue;
        auto own = clearances.segment(part.first_target, part.sensor().target_count());
        VectorXd sorted = own;
        std::ranges::sort(sorted, std::greater<>());
        own = own.cwiseMin(sorted[std::min(part.sensor().least_in_view(), sorted.size()) - 1]);
    }
}

SightLines CombinedSensor::sight_lines(const Isometry3d& world_from_flange,
                                       const VectorXd& unknowns) const {
    SightLines all;
    for (const Part& part : parts_) {
        const Isometry3d first_from_part = frame_of(part, unknowns);
        const SightLines own = part.sensor().sight_lines(
            first_from_part.inverse() * world_from_flange, unknowns(part.unknowns));
        if (own.cols() == 0) continue;
        if (all.cols() == 0) all.setZero(6, target_count());
        for (Index j = 0; j < own.cols(); ++j) {
            all.col(part.first_target + j) << first_from_part * Vector3d(own.col(j).head<3>()),
                first_from_part * Vector3d(own.col(j).tail<3>());
        }
    }
    return all;
}

Index CombinedSensor::least_in_view() const {
    Index in_one_view = 0;
    Index others = 0;
    for (const Part& part : parts_) {
        const Sensor& sensor = part.sensor();
        if (!sensor.has_view()) {
            others += sensor.target_count();
        } else if (in_one_view == 0 || sensor.least_in_view() < in_one_view) {
            in_one_view = sensor.least_in_view();
        }
    }
    return in_one_view + others;
}

bool CombinedSensor::needs_first_guess() const {
    return std::ranges::any_of(parts_,
                               [](const Part& part) { return part.sensor().needs_first_guess(); });
}

std::vector<std::string> CombinedSensor::observation_names() const {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const std::string prefix = parts_[k].has_own_rows ? "" : fmt::format("s{}_", k + 1);
        const auto own = with_prefix(prefix, parts_[k].sensor().observation_names());
        names.insert(names.end(), own.begin(), own.end());
    }
    return names;
}

std::vector<std::string> CombinedSensor::unknown_names() const {
    std::vector<std::string> names(static_cast<std::size_t>(unknown_count_));
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const Part& part = parts_[k];
        const std::string number = fmt::format("sensor{}.", k + 1);
        const auto own =
            with_prefix(part.has_own_unknowns ? "" : number, part.sensor().unknown_names());
        for (std::size_t i = 0; i < own.size(); ++i) {
            if (!part.is_shared[i]) names[static_cast<std::size_t>(part.unknowns[i])] = own[i];
        }
        auto next = static_cast<std::size_t>(part.frame);
        if (part.frame < 0 || !names[next].empty()) continue;
        for (const char* const name : {"x", "y", "z", "rx", "ry", "rz"}) {
            names[next++] = number + name;
        }
    }
    return names;
}

std::vector<bool> CombinedSensor::unknown_is_angle() const {
    std::vector<bool> is_angle(static_cast<std::size_t>(unknown_count_), false);
    for (const Part& part : parts_) {
        const std::vector<bool> own = part.sensor().unknown_is_angle();
        for (std::size_t i = 0; i < own.size(); ++i) {
            is_angle[static_cast<std::size_t>(part.unknowns[i])] = own[i];
        }
        if (part.frame >= 0) std::fill_n(is_angle.begin() + part.frame + 3, 3, true);
    }
    return is_angle;
}

std::vector<const AmountUnits*> CombinedSensor::unknown_units() const {
    std::vector<const AmountUnits*> units = Sensor::unknown_units();
    for (const Part& part : parts_) {
        const auto own = part.sensor().unknown_units();
        for (std::size_t i = 0; i < own.size(); ++i) {
            units[static_cast<std::size_t>(part.unknowns[i])] = own[i];
        }
    }
    return units;
}

VectorXd CombinedSensor::unknown_sizes() const {
    std::vector<double> sizes;
    for (const Part& part : parts_) {
        const VectorXd own = part.sensor().unknown_sizes();
        for (Index k = 0; k < own.size(); ++k) {
            if (!part.is_shared[static_cast<std::size_t>(k)]) sizes.push_back(own[k]);
        }
    }
    return Eigen::Map<const VectorXd>(sizes.data(), std::ssize(sizes));
}

std::vector<NoiseNumber> CombinedSensor::noise_numbers() const {
    std::vector<NoiseNumber> numbers;
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        for (NoiseNumber& number : parts_[k].sensor().noise_numbers()) {
            numbers.push_back({fmt::format("sensor{}_{}", k + 1, number.name), number.values});
        }
    }
    return numbers;
}

SensorWords CombinedSensor::words() const {
    std::vector<std::string> readings, places, unknowns, sentences;
    const auto add = [](std::vector<std::string>& words, const std::string& word) {
        if (std::ranges::find(words, word) == words.end()) words.push_back(word);
    };
    SensorWords words;
    words.known = {"base.known"};
    for (std::size_t k = 0; k < parts_.size(); ++k) {
        const SensorWords own = parts_[k].sensor().words();
        add(readings, own.readings);
        add(places, own.place);
        add(unknowns, own.unknowns);
        const auto& same = parts_[k].stated.same_camera;
        sentences.push_back(
            same ? fmt::format("{}) {} corners of another board, seen by the same camera as {})",
                               k + 1, parts_[k].sensor().target_count(), *same + 1)
                 : fmt::format("{}) {}", k + 1, own.sentence));
        if (k == 0) words.key = key_of(own.key, 0);
        for (const std::string& key : own.known) add(words.known, key_of(key, k));
        if (parts_[k].frame >= 0) add(words.known, fmt::format("sensors[{}].frame", k + 1));
    }
    if (unknown_count_ > 0 && parts_.back().frame >= 0) {
        unknowns.emplace_back("frames of further sensors in the first one's");
    }
    words.readings = detail::list_words(readings);
    words.place = detail::list_words(places);
    words.unknowns = fmt::format("{}", fmt::join(unknowns, ", "));
    words.sentence = fmt::format("{}", fmt::join(sentences, "; "));
    return words;
}

}  // namespace posewise
