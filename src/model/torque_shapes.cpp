#include <algorithm>
#include <cmath>

#include "chain_checks.hpp"
#include "core/statistics.hpp"
#include "element_amount.hpp"
#include "posewise/model/error_terms.hpp"
#include "sampling.hpp"

namespace posewise {
namespace {

constexpr Index samples = 256;
constexpr std::uint64_t configuration_seed = 1;  // any: it only has to be the same every time

/// A mass beside the flange is so far from it, of the robot's extent: how far makes no difference
/// to the shape.
constexpr double beside = 0.1;
/// Shapes below this share of a joint's largest are dropped.
constexpr double negligible = 0.03;
/// Below this share of what the masses could do a moment is rounding.
constexpr double rounding = 1e-9;

/// A mass at a link's origin, or one beside the flange and its negative there.
struct Probe {
    std::string name;
    std::vector<Load> loads;
};

std::vector<Probe> make_probes(const Chain& chain, double distance) {
    std::vector<Probe> probes;
    for (Index link = 1; link <= chain.joint_count() + 1; ++link) {
        const std::string name =
            link <= chain.joint_count() ? chain.joint(link - 1).name : "flange";
        probes.push_back({name, {{link, 1, Vector3d::Zero()}}});
    }
    const Index flange = chain.joint_count() + 1;
    for (Index axis = 0; axis < 3; ++axis) {
        const Vector3d center = distance * Vector3d::Unit(axis);
        probes.push_back({std::string("flange.") + static_cast<char>('x' + axis),
                          {{flange, 1, center}, {flange, -1, Vector3d::Zero()}}});
    }
    return probes;
}

/// A combination of probes, and what its moment is divided by.
struct TorqueShape {
    std::string name;
    std::vector<Load> loads;
    double size = 1;
};

/// Values of every probe's moment about one element, times the factor of `bend`, samples x probes,
/// less their means.
MatrixXd evaluate_moments(const std::shared_ptr<const GravityTorque::Arm>& arm, Index driven,
                          const Vector3d& gravity, const std::vector<Probe>& probes,
                          const RowMatrixXd& configurations, const JointFunction& bend) {
    std::vector<GravityTorque> torques;
    for (const Probe& probe : probes) torques.emplace_back(arm, driven, gravity, probe.loads, 1.0);
    MatrixXd moments(configurations.rows(), static_cast<Index>(probes.size()));
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        for (std::size_t k = 0; k < probes.size(); ++k) {
            moments(i, static_cast<Index>(k)) =
                detail::torque_factor(bend, q) * torques[k].value(q);
        }
    }
    moments.rowwise() -= moments.colwise().mean().eval();
    return moments;
}

/// By Gram-Schmidt in the order of the probes: masses at the origins from the joint outwards, which
/// do most, then those beside the flange.
std::vector<TorqueShape> find_shapes(const MatrixXd& moments, const std::vector<Probe>& probes,
                                     double extent) {
    const double root = std::sqrt(static_cast<double>(moments.rows()));
    const double largest = moments.colwise().norm().maxCoeff();
    std::vector<TorqueShape> shapes;
    if (largest <= rounding * extent * root) return shapes;
    MatrixXd Q(moments.rows(), moments.cols());
    MatrixXd combinations(moments.cols(), moments.cols());  // Q = moments * combinations
    Index count = 0;
    for (Index k = 0; k < moments.cols(); ++k) {
        VectorXd residual = moments.col(k);
        VectorXd combination = VectorXd::Unit(moments.cols(), k);
        for (int pass = 0; pass < 2; ++pass) {
            const VectorXd along = Q.leftCols(count).transpose() * residual;
            residual -= Q.leftCols(count) * along;
            combination -= combinations.leftCols(count) * along;
        }
        const double norm = residual.norm();
        if (norm <= negligible * largest) continue;
        Q.col(count) = residual / norm;
        combinations.col(count) = combination / norm;
        TorqueShape shape{
            probes[static_cast<std::size_t>(k)].name, {}, std::sqrt(2.0) * largest / root};
        for (Index p = 0; p < moments.cols(); ++p) {
            for (Load load : probes[static_cast<std::size_t>(p)].loads) {
                load.mass *= combination[p];
                if (load.mass != 0) shape.loads.push_back(load);
            }
        }
        shapes.push_back(std::move(shape));
        ++count;
    }
    return shapes;
}

/// The robot, and where it has what bends under its weights.
struct Bending {
    struct Place {
        std::size_t element = 0;
        std::string name;  ///< before ".torque(...)"
        /// Without its torque. Of a slide it has how far that is out, as a part of its range.
        JointFunction bend = {JointFunction::Shape::Torque, {}, 0, nullptr};
    };
    std::vector<Element> elements;
    std::vector<Place> places;        ///< in the order of the elements
    std::vector<std::size_t> slides;  ///< those of the places that no joint drives
};

/// Joints that turn; and behind each slide rotations about the middle of what is out, where a beam
/// that a moment at its end bends seems to turn [beam theory: its end turns by M l / EI and moves
/// by half of that times l].
Bending find_bending(const Chain& chain) {
    Bending bending;
    const std::vector<Index> owners = element_owners(chain);
    for (std::size_t k = 0; k < owners.size(); ++k) {
        const Element& element = chain.elements()[k];
        bending.elements.push_back(element);
        if (owners[k] < 0) continue;
        const Joint& joint = chain.joint(owners[k]);
        if (element.motion == Motion::Rotation) {
            bending.places.push_back({bending.elements.size() - 1, joint.name});
            continue;
        }
        const auto own = std::ranges::find(element.joints, owners[k], &JointTerm::joint);
        const double range = joint.upper - joint.lower;
        if (!(range > 0)) continue;
        Element half{Motion::Translation,
                     element.axis,
                     own->coefficient * joint.lower / 2,
                     {{owners[k], -own->coefficient / 2}}};
        bending.elements.push_back(half);
        for (const auto& [axis, name] :
             {std::pair(Axis::X, ".Rx"), std::pair(Axis::Y, ".Ry"), std::pair(Axis::Z, ".Rz")}) {
            bending.slides.push_back(bending.elements.size());
            bending.places.push_back({bending.elements.size(),
                                      joint.name + name,
                                      {JointFunction::Shape::Torque,
                                       {{owners[k], 1 / range}},
                                       -joint.lower / range,
                                       nullptr}});
            bending.elements.push_back({Motion::Rotation, axis, 0, {}});
        }
        half.value = -half.value;
        half.joints.front().coefficient = -half.joints.front().coefficient;
        bending.elements.push_back(half);
    }
    return bending;
}

}  // namespace

double extent(const Chain& chain) {
    const RowMatrixXd configurations =
        detail::random_configurations(chain, samples, configuration_seed);
    const VectorXd nominal = VectorXd::Zero(chain.parameter_count());
    RowMatrixXd flange(samples, 3);
    for (Index i = 0; i < samples; ++i) {
        flange.row(i) = chain.base_from_flange(configurations.row(i).transpose(), nominal)
                            .translation()
                            .transpose();
    }
    return detail::rms_spread(flange);
}

Chain with_torque_shapes(const Chain& chain, const Vector3d& direction) {
    detail::check_direction(direction);
    const Vector3d gravity = direction.stableNormalized();
    Bending bending = find_bending(chain);
    const auto arm = std::make_shared<const GravityTorque::Arm>(
        chain.with_elements(bending.elements), bending.slides);
    const RowMatrixXd configurations =
        detail::random_configurations(arm->chain(), samples, configuration_seed);
    const double size = extent(arm->chain());
    const std::vector<Probe> probes = make_probes(chain, beside * size);
    for (const Bending::Place& place : bending.places) {
        const Index driven = arm->count_before(place.element);
        const MatrixXd moments =
            evaluate_moments(arm, driven, gravity, probes, configurations, place.bend);
        for (const TorqueShape& shape : find_shapes(moments, probes, size)) {
            JointFunction bend = place.bend;
            bend.torque = std::make_shared<const GravityTorque>(arm, driven, gravity, shape.loads,
                                                                shape.size);
            bending.elements[place.element].terms.push_back(
                {place.name + ".torque(" + shape.name + ')', std::move(bend), TermKind::Torque});
        }
    }
    return chain.with_elements(std::move(bending.elements));
}

}  // namespace posewise
