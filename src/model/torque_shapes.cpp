#include <cmath>

#include "chain_checks.hpp"
#include "core/statistics.hpp"
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

/// Values of every probe's moment about one driven element, samples x probes, less their means.
MatrixXd evaluate_moments(const std::shared_ptr<const GravityTorque::Arm>& arm, Index driven,
                          const Vector3d& gravity, const std::vector<Probe>& probes,
                          const RowMatrixXd& configurations) {
    std::vector<GravityTorque> torques;
    for (const Probe& probe : probes) torques.emplace_back(arm, driven, gravity, probe.loads, 1.0);
    MatrixXd moments(configurations.rows(), static_cast<Index>(probes.size()));
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        for (std::size_t k = 0; k < probes.size(); ++k) {
            moments(i, static_cast<Index>(k)) = torques[k].value(q);
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
    const auto arm = std::make_shared<const GravityTorque::Arm>(chain);
    const RowMatrixXd configurations =
        detail::random_configurations(arm->chain(), samples, configuration_seed);
    const double size = extent(arm->chain());
    const std::vector<Probe> probes = make_probes(chain, beside * size);
    const std::vector<Index> owners = element_owners(chain);
    std::vector<Element> elements = chain.elements();
    Index driven = -1;
    for (std::size_t k = 0; k < elements.size(); ++k) {
        if (elements[k].joints.empty()) continue;
        ++driven;
        if (owners[k] < 0 || elements[k].motion != Motion::Rotation) continue;
        const MatrixXd moments = evaluate_moments(arm, driven, gravity, probes, configurations);
        for (const TorqueShape& shape : find_shapes(moments, probes, size)) {
            elements[k].terms.push_back(
                {chain.joint(owners[k]).name + ".torque(" + shape.name + ')',
                 {JointFunction::Shape::Torque,
                  {},
                  0,
                  std::make_shared<const GravityTorque>(arm, driven, gravity, shape.loads,
                                                        shape.size)},
                 TermKind::Torque});
        }
    }
    return chain.with_elements(std::move(elements));
}

}  // namespace posewise
