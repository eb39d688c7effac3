#include "posewise/model/gravity_torque.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "sampling.hpp"

namespace posewise {
namespace {

/// The robot with an error parameter on each driven element and nowhere else.
Chain with_driven_parameters(const Chain& chain) {
    std::vector<Element> elements = without_parameters(chain).elements();
    for (std::size_t k = 0; k < elements.size(); ++k) {
        if (!elements[k].joints.empty()) elements[k].parameter = "element " + std::to_string(k);
    }
    return Chain(chain.joints(), std::move(elements));
}

void check_load(const Chain& chain, const Load& load) {
    if (load.link < 0 || load.link > chain.joint_count() + 1) {
        throw InputError("a load is on link " + std::to_string(load.link) + ", must be from 0 to " +
                         std::to_string(chain.joint_count() + 1));
    }
    if (!std::isfinite(load.mass) || load.mass < 0 || !load.center.allFinite()) {
        throw InputError("a load on link " + std::to_string(load.link) +
                         " has a mass or a centre that is negative or not finite");
    }
}

/// How many driven elements are up to the first one that joint `link` (from 1) drives.
Index count_driven(const Chain& chain, Index link) {
    Index count = 0;
    for (const Element& element : chain.elements()) {
        if (link == 0) return 0;
        if (element.joints.empty()) continue;
        ++count;
        for (const JointTerm& term : element.joints) {
            if (term.joint == link - 1) return count;
        }
    }
    return count;
}

TorqueShare divided(TorqueShare torque, double largest) {
    torque.value /= largest;
    torque.gradient /= largest;
    torque.hessian /= largest;
    return torque;
}

}  // namespace

GravityTorque::GravityTorque(const Chain& chain, std::size_t element, const Vector3d& gravity,
                             std::vector<Load> loads)
    : chain_(with_driven_parameters(chain)), gravity_(gravity), loads_(std::move(loads)) {
    if (element >= chain.elements().size() || chain.elements()[element].joints.empty()) {
        throw InputError("the torque is of an element that no joint drives");
    }
    if (!gravity.allFinite()) throw InputError("gravity is not finite");
    for (std::size_t k = 0; k < element; ++k) driven_ += chain.elements()[k].joints.empty() ? 0 : 1;
    for (const Load& load : loads_) {
        check_load(chain, load);
        moved_by_.push_back(count_driven(chain, load.link));
    }
    driven_by_.setZero(chain_.parameter_count(), chain_.joint_count());
    for (Index e = 0; e < chain_.parameter_count(); ++e) {
        for (const JointTerm& term : chain_.parameter_element(e).joints) {
            driven_by_(e, term.joint) += term.coefficient;
        }
    }
    constexpr Index samples = 1000;
    const RowMatrixXd configurations = detail::random_configurations(chain_, samples, 1);
    double low = 0, high = 0, moment = 0;
    for (Index i = 0; i < samples; ++i) {
        const VectorXd q = configurations.row(i).transpose();
        const double value = torque(q, false).value;
        moment = std::max(moment, moment_about_base(q));
        low = i == 0 ? value : std::min(low, value);
        high = i == 0 ? value : std::max(high, value);
    }
    const double size = std::max(std::abs(low), std::abs(high));
    constexpr double rounding = 1e-6;  // of the loads at their distances from the base
    varies_ = high - low > rounding * moment;
    if (size > 0) largest_ = size;
}

double GravityTorque::moment_about_base(const VectorXd& q) const {
    const std::vector<Isometry3d> links =
        chain_.base_from_links(q, VectorXd::Zero(chain_.parameter_count()));
    double moment = 0;
    for (const Load& load : loads_) {
        const Vector3d center = links[static_cast<std::size_t>(load.link)] * load.center;
        moment += load.mass * gravity_.norm() * center.norm();
    }
    return moment;
}

TorqueShare GravityTorque::evaluate(const VectorXd& q) const {
    return divided(torque(q, false), largest_);
}

TorqueShare GravityTorque::evaluate_twice(const VectorXd& q) const {
    return divided(torque(q, true), largest_);
}

TorqueShare GravityTorque::torque(const VectorXd& q, bool is_twice) const {
    const VectorXd joints = q.head(chain_.joint_count());
    const VectorXd nominal = VectorXd::Zero(chain_.parameter_count());
    FlangeMotion motion;
    chain_.differentiate(Isometry3d::Identity(), joints, nominal, motion);
    const std::vector<Isometry3d> links = chain_.base_from_links(joints, nominal);
    const Index count = chain_.parameter_count();
    const auto w = [&motion](Index e) { return Vector3d(motion.twists.col(6 + e).head<3>()); };

    // By driven elements: the torque of element E is m g . D_E c. What element i moves turns with
    // it, so that D_i D_j c = w_i x D_j c for i before j, and likewise once more.
    double value = 0;
    VectorXd gradient = VectorXd::Zero(count);
    MatrixXd hessian = MatrixXd::Zero(is_twice ? count : 0, is_twice ? count : 0);
    for (std::size_t l = 0; l < loads_.size(); ++l) {
        if (driven_ >= moved_by_[l]) continue;
        const Vector3d center = links[static_cast<std::size_t>(loads_[l].link)] * loads_[l].center;
        const Vector3d weight = loads_[l].mass * gravity_;
        const auto rate = [&](Index e) {
            return Vector3d(motion.twists.col(6 + e).tail<3>() + w(e).cross(center));
        };
        value += weight.dot(rate(driven_));
        for (Index i = 0; i < moved_by_[l]; ++i) {
            const auto [first, second] = std::minmax(i, driven_);
            const Vector3d twice = w(first).cross(rate(second));
            gradient[i] += weight.dot(twice);
            for (Index h = 0; is_twice && h <= i; ++h) {
                std::array<Index, 3> order{h, i, driven_};
                std::sort(order.begin(), order.end());
                const double third =
                    weight.dot(w(order[0]).cross(w(order[1]).cross(rate(order[2]))));
                hessian(h, i) += third;
                if (h != i) hessian(i, h) += third;
            }
        }
    }
    TorqueShare share{value, driven_by_.transpose() * gradient, {}};
    if (is_twice) share.hessian = driven_by_.transpose() * hessian * driven_by_;
    return share;
}

}  // namespace posewise
