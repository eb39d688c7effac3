#include "posewise/measurement/campaign.hpp"

#include <algorithm>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

constexpr std::array<const char*, 6> base_names{"base.x",  "base.y",  "base.z",
                                                "base.rx", "base.ry", "base.rz"};

/// Which of the base's six are parameters, in their order.
std::vector<Index> unknown_of_base(const Campaign& campaign) {
    std::vector<Index> unknown;
    for (Index k = 0; k < 6; ++k) {
        if (!campaign.base_is_known[static_cast<std::size_t>(k)]) unknown.push_back(k);
    }
    return unknown;
}

/// Removes the twists of what is known of the base.
void drop_known_of_base(const Campaign& campaign, TwistMatrix& twists) {
    if (base_parameter_count(campaign) == 6) return;
    std::vector<Index> kept = unknown_of_base(campaign);
    for (Index k = 6; k < twists.cols(); ++k) kept.push_back(k);
    twists = twists(Eigen::all, kept).eval();
}

}  // namespace

Index base_parameter_count(const Campaign& campaign) {
    const auto& known = campaign.base_is_known;
    return std::count(known.begin(), known.end(), false);
}

Index parameter_count(const Campaign& campaign) {
    return base_parameter_count(campaign) + campaign.robot.parameter_count() +
           static_cast<Index>(campaign.sensor->unknown_names().size());
}

std::vector<std::string> parameter_names(const Campaign& campaign) {
    std::vector<std::string> names;
    for (const Index k : unknown_of_base(campaign)) {
        names.emplace_back(base_names[static_cast<std::size_t>(k)]);
    }
    for (const auto& name : campaign.robot.parameter_names()) names.push_back(name);
    for (const auto& name : campaign.sensor->unknown_names()) names.push_back(name);
    return names;
}

std::vector<bool> parameter_is_angle(const Campaign& campaign) {
    std::vector<bool> is_angle(static_cast<std::size_t>(parameter_count(campaign)));
    std::size_t next = 0;
    for (const Index k : unknown_of_base(campaign)) is_angle[next++] = k >= 3;
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        is_angle[next++] = campaign.robot.parameter_element(k).motion == Motion::Rotation;
    }
    for (const bool of_sensor : campaign.sensor->unknown_is_angle()) is_angle[next++] = of_sensor;
    return is_angle;
}

std::vector<const AmountUnits*> parameter_units(const Campaign& campaign) {
    std::vector<const AmountUnits*> units;
    for (const bool is_angle : parameter_is_angle(campaign)) units.push_back(&units_of(is_angle));
    const auto of_sensor = campaign.sensor->unknown_units();
    std::ranges::copy(of_sensor, units.end() - std::ssize(of_sensor));
    return units;
}

double& size_of(ParameterSpread& spread, const Chain& robot, Index parameter) {
    const Element& element = robot.parameter_element(parameter);
    const bool turns = element.motion == Motion::Rotation;
    const ErrorTerm* const term = robot.parameter_term(parameter);
    if (term != nullptr && term->kind == TermKind::Harmonic) {
        return turns ? spread.harmonic : spread.slide_harmonic;
    }
    if (term != nullptr && term->kind == TermKind::Tilt) return spread.tilt;
    if (term != nullptr && term->kind == TermKind::Gain) return spread.gain;
    if (term != nullptr && term->kind != TermKind::Free) return spread.gravity;
    const bool is_offset = term == nullptr && turns && !element.joints.empty();
    if (is_offset && spread.offset) return *spread.offset;
    return turns ? spread.angle : spread.length;
}

VectorXd robot_error_sizes(const ParameterSpread& spread, const Chain& robot) {
    ParameterSpread by_kind = spread;
    VectorXd sizes(robot.parameter_count());
    const auto names = robot.parameter_names();
    for (Index k = 0; k < sizes.size(); ++k) {
        const auto stated = spread.by_name.find(names[static_cast<std::size_t>(k)]);
        sizes[k] = stated != spread.by_name.end() ? stated->second : size_of(by_kind, robot, k);
    }
    return sizes;
}

std::vector<SharedSize> shared_sizes(const ParameterSpread& spread, const Chain& robot) {
    ParameterSpread sizes = spread;
    const auto key_of = [&](const double* size) {
        if (size == &sizes.length) return "length";
        if (size == &sizes.angle) return "angle";
        if (size == &sizes.gravity) return "gravity";
        if (size == &sizes.tilt) return "tilt";
        if (size == &sizes.gain) return "gain";
        if (size == &sizes.slide_harmonic) return "slide_harmonic";
        return size == &sizes.harmonic ? "harmonic" : "offset";
    };
    const auto names = robot.parameter_names();
    std::vector<SharedSize> shared;
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        if (sizes.by_name.contains(names[static_cast<std::size_t>(k)])) continue;
        const double& size = size_of(sizes, robot, k);
        const std::string key = key_of(&size);
        auto found = std::find_if(shared.begin(), shared.end(),
                                  [&](const SharedSize& one) { return one.key == key; });
        if (found == shared.end()) {
            const bool is_angle = key != "length" && key != "slide_harmonic";
            found = shared.insert(found, {key, size, is_angle, {}});
        }
        found->members.push_back(k);
    }
    return shared;
}

VectorXd parameter_scale(const Campaign& campaign) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    const Index robot_begin = base_parameter_count(campaign);
    VectorXd scale(static_cast<Index>(names.size()));
    for (std::size_t k = 0; k < names.size(); ++k) {
        scale[static_cast<Index>(k)] = is_angle[k] ? campaign.spread.angle : campaign.spread.length;
    }
    scale.segment(robot_begin, campaign.robot.parameter_count()) =
        robot_error_sizes(campaign.spread, campaign.robot);
    const VectorXd of_sensor = campaign.sensor->unknown_sizes();
    scale.segment(robot_begin + campaign.robot.parameter_count(), of_sensor.size()) = of_sensor;
    for (const auto& [name, size] : campaign.spread.by_name) {
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end()) {
            throw InputError("spread names parameter '" + name +
                             "', which this robot and sensor do not have");
        }
        scale[found - names.begin()] = size;
    }
    return scale;
}

Index prior_begin(const Campaign& campaign) {
    const Index base = base_parameter_count(campaign);
    if (!campaign.spread.is_prior) return base + campaign.robot.parameter_count();
    return campaign.prior && campaign.prior->has_base ? 0 : base;
}

Index prior_count(const Campaign& campaign) {
    const bool is_all_of_sensor =
        campaign.spread.is_prior && campaign.prior && campaign.prior->has_sensor;
    const Index end = is_all_of_sensor
                          ? parameter_count(campaign)
                          : base_parameter_count(campaign) + campaign.robot.parameter_count() +
                                campaign.sensor->unknown_sizes().size();
    return end - prior_begin(campaign);
}

Parameters advance(const Campaign& campaign, const Parameters& parameters, const VectorXd& step) {
    Parameters moved = parameters;
    Twist base = Twist::Zero();  // translation, turn
    Index next = 0;
    for (const Index k : unknown_of_base(campaign)) base[k] = step[next++];
    const Vector3d phi = base.tail<3>();
    if (phi.squaredNorm() > 0) {
        // Through a unit quaternion, so that rounding never accumulates into a non-rotation.
        moved.world_from_base.linear() =
            Eigen::Quaterniond(rotation_from_vector(phi) * parameters.world_from_base.linear())
                .normalized()
                .toRotationMatrix();
    }
    moved.world_from_base.translation() += base.head<3>();
    moved.robot += step.segment(next, parameters.robot.size());
    moved.sensor += step.tail(parameters.sensor.size());
    return moved;
}

VectorXd step_between(const Campaign& campaign, const Parameters& from, const Parameters& to) {
    const Isometry3d& base = from.world_from_base;
    const Eigen::AngleAxisd turn(to.world_from_base.linear() * base.linear().transpose());
    Twist of_base;  // translation, turn
    of_base << to.world_from_base.translation() - base.translation(), turn.angle() * turn.axis();
    const std::vector<Index> unknown = unknown_of_base(campaign);
    VectorXd step(std::ssize(unknown) + from.robot.size() + from.sensor.size());
    step << of_base(unknown), to.robot - from.robot, to.sensor - from.sensor;
    return step;
}

MatrixXd differentiate_step(const Campaign& campaign, const Parameters& from,
                            const Parameters& to) {
    const Index size = parameter_count(campaign);
    MatrixXd derivative = MatrixXd::Identity(size, size);
    const Eigen::AngleAxisd turn(to.world_from_base.linear() *
                                 from.world_from_base.linear().transpose());
    const double angle = turn.angle();
    const Matrix3d K = cross_matrix(turn.axis());
    const double curvature =
        angle < 1e-4 ? angle * angle / 12 : 1 - angle / 2 / std::tan(angle / 2);
    Eigen::Matrix<double, 6, 6> of_base = Eigen::Matrix<double, 6, 6>::Identity();
    of_base.bottomRightCorner<3, 3>() += curvature * K * K - angle / 2 * K;
    const std::vector<Index> unknown = unknown_of_base(campaign);
    derivative.topLeftCorner(std::ssize(unknown), std::ssize(unknown)) = of_base(unknown, unknown);
    return derivative;
}

Isometry3d world_from_flange(const Campaign& campaign, const Parameters& parameters,
                             const VectorXd& configuration) {
    return parameters.world_from_base *
           campaign.robot.base_from_flange(configuration, parameters.robot);
}

void differentiate_flange(const Campaign& campaign, const Parameters& parameters,
                          const VectorXd& configuration, FlangeMotion& motion) {
    campaign.robot.differentiate(parameters.world_from_base, configuration, parameters.robot,
                                 motion, campaign.joint_repeatability.size() > 0);
    drop_known_of_base(campaign, motion.twists);
}

void differentiate_flange_twice(const Campaign& campaign, const Parameters& parameters,
                                const VectorXd& configuration, FlangeMotion& motion,
                                std::vector<FlangeMotionRate>& rates) {
    campaign.robot.differentiate_twice(parameters.world_from_base, configuration, parameters.robot,
                                       motion, rates);
    drop_known_of_base(campaign, motion.twists);
    for (FlangeMotionRate& rate : rates) drop_known_of_base(campaign, rate.twists);
}

Campaign with_robot(const Campaign& campaign, Chain robot) {
    Campaign changed = campaign;
    changed.robot = std::move(robot);
    changed.nominal.robot = VectorXd::Zero(changed.robot.parameter_count());
    changed.prior.reset();
    const auto names = parameter_names(changed);
    std::erase_if(changed.spread.by_name, [&](const auto& entry) {
        return std::find(names.begin(), names.end(), entry.first) == names.end();
    });
    return changed;
}

}  // namespace posewise
