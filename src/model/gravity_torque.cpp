#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/model/error_terms.hpp"
#include "sampling.hpp"

namespace posewise {
namespace {

/// The robot with an error parameter on each driven element, and on these, and nowhere else.
Chain with_driven_parameters(const Chain& chain, const std::vector<std::size_t>& also) {
    std::vector<Element> elements = without_parameters(chain).elements();
    for (std::size_t k = 0; k < elements.size(); ++k) {
        elements[k].known_terms.clear();  // which bend it too little to matter
        const bool is_asked_for = std::find(also.begin(), also.end(), k) != also.end();
        if (!elements[k].joints.empty() || is_asked_for)
            elements[k].parameter = "element " + std::to_string(k);
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

/// Mass times centre in the base frame; `moment` is that in the frame of the link.
Vector3d first_moment(const Isometry3d& link, double mass, const Vector3d& moment) {
    return link.linear() * moment + mass * link.translation();
}

/// How a first moment changes as what carries it moves by a twist.
Vector3d rate_of(double mass, const Vector3d& first_moment, const Eigen::Ref<const Twist>& twist) {
    return mass * twist.tail<3>() + twist.head<3>().cross(first_moment);
}

TorqueShare divided(TorqueShare torque, double largest) {
    torque.value /= largest;
    torque.gradient /= largest;
    torque.hessian /= largest;
    return torque;
}

}  // namespace

// ---- The arm ----

GravityTorque::Arm::Arm(const Chain& chain, const std::vector<std::size_t>& also)
    : chain_(with_driven_parameters(chain, also)) {
    static std::atomic<std::uint64_t> last{0};
    number_ = ++last;
    driven_by_.setZero(driven_count(), joint_count());
    for (Index e = 0; e < driven_count(); ++e) {
        for (const JointTerm& term : chain_.parameter_element(e).joints) {
            driven_by_(e, term.joint) += term.coefficient;
        }
    }
}

const GravityTorque::Arm::Motion& GravityTorque::Arm::at(const VectorXd& q) const {
    struct Memory {
        std::uint64_t number = 0;
        VectorXd joints;
        Motion motion;
    };
    thread_local Memory memory;
    const auto joints = q.head(joint_count());
    if (memory.number == number_ && memory.joints == joints) return memory.motion;
    memory.number = 0;  // in case of an exception
    memory.joints = joints;
    const VectorXd nominal = VectorXd::Zero(chain_.parameter_count());
    chain_.differentiate(Isometry3d::Identity(), memory.joints, nominal, memory.motion.flange);
    memory.motion.links = chain_.base_from_links(memory.joints, nominal);
    memory.number = number_;
    return memory.motion;
}

Index GravityTorque::Arm::count_driven(Index link) const {
    Index count = 0;
    for (const Element& element : chain_.elements()) {
        if (link == 0) return 0;
        if (element.parameter.empty()) continue;
        ++count;
        for (const JointTerm& term : element.joints) {
            if (term.joint == link - 1) return count;
        }
    }
    return count;
}

Index GravityTorque::Arm::count_before(std::size_t element) const {
    const auto begin = chain_.elements().begin();
    return std::count_if(begin, begin + static_cast<std::ptrdiff_t>(element),
                         [](const Element& one) { return !one.parameter.empty(); });
}

// ---- The torque ----

GravityTorque::GravityTorque(std::shared_ptr<const Arm> arm, Index driven, const Vector3d& gravity,
                             const std::vector<Load>& loads, double largest)
    : arm_(std::move(arm)), driven_(driven), gravity_(gravity), largest_(largest), varies_(true) {
    weigh(loads);
}

GravityTorque::GravityTorque(const Chain& chain, std::size_t element, const Vector3d& gravity,
                             std::vector<Load> loads)
    : arm_(std::make_shared<const Arm>(chain)), gravity_(gravity) {
    if (element >= chain.elements().size() || chain.elements()[element].joints.empty()) {
        throw InputError("the torque is of an element that no joint drives");
    }
    if (!gravity.allFinite()) throw InputError("gravity is not finite");
    driven_ = arm_->count_before(element);
    for (const Load& load : loads) check_load(chain, load);
    weigh(loads);
    constexpr Index samples = 1000;
    const RowMatrixXd configurations = detail::random_configurations(arm_->chain(), samples, 1);
    double low = 0, high = 0, moment = 0;
    for (Index i = 0; i < samples; ++i) {
        const VectorXd q = configurations.row(i).transpose();
        const double value = largest_ * this->value(q);
        moment = std::max(moment, moment_about_base(q));
        low = i == 0 ? value : std::min(low, value);
        high = i == 0 ? value : std::max(high, value);
    }
    const double size = std::max(std::abs(low), std::abs(high));
    constexpr double rounding = 1e-6;  // of the loads at their distances from the base
    varies_ = high - low > rounding * moment;
    if (size > 0) largest_ = size;
}

void GravityTorque::weigh(const std::vector<Load>& loads) {
    for (const Load& load : loads) {
        const auto same = [&](const LinkWeight& weight) { return weight.link == load.link; };
        auto found = std::find_if(weights_.begin(), weights_.end(), same);
        if (found == weights_.end()) {
            weights_.push_back({load.link, arm_->count_driven(load.link)});
            found = weights_.end() - 1;
        }
        found->mass += load.mass;
        found->moment += load.mass * load.center;
    }
}

double GravityTorque::moment_about_base(const VectorXd& q) const {
    const std::vector<Isometry3d>& links = arm_->at(q).links;
    double moment = 0;
    for (const LinkWeight& weight : weights_) {
        const Isometry3d& link = links[static_cast<std::size_t>(weight.link)];
        const Vector3d first = first_moment(link, weight.mass, weight.moment);
        moment += gravity_.norm() * first.norm();
    }
    return moment;
}

double GravityTorque::value(const VectorXd& q) const {
    const Arm::Motion& motion = arm_->at(q);
    const Twist twist = motion.flange.twists.col(6 + driven_);
    double torque = 0;
    for (const LinkWeight& weight : weights_) {
        if (driven_ >= weight.moved_by) continue;
        const Isometry3d& link = motion.links[static_cast<std::size_t>(weight.link)];
        torque += gravity_.dot(
            rate_of(weight.mass, first_moment(link, weight.mass, weight.moment), twist));
    }
    return torque / largest_;
}

TorqueShare GravityTorque::evaluate(const VectorXd& q) const {
    return divided(torque(q, false), largest_);
}

TorqueShare GravityTorque::evaluate_twice(const VectorXd& q) const {
    return divided(torque(q, true), largest_);
}

TorqueShare GravityTorque::torque(const VectorXd& q, bool is_twice) const {
    const Arm::Motion& motion = arm_->at(q);
    const TwistMatrix& twists = motion.flange.twists;
    const Index count = arm_->driven_count();
    const auto w = [&](Index e) { return twists.col(6 + e).head<3>(); };

    // By driven elements: the torque of element E is g . D_E (m c). What element i moves turns with
    // it, so that D_i D_j c = w_i x D_j c for i before j, and likewise once more.
    const Vector3d pull = gravity_.cross(w(driven_));
    double value = 0;
    VectorXd gradient = VectorXd::Zero(count);
    MatrixXd hessian = MatrixXd::Zero(is_twice ? count : 0, is_twice ? count : 0);
    for (const LinkWeight& weight : weights_) {
        if (driven_ >= weight.moved_by) continue;
        const Isometry3d& link = motion.links[static_cast<std::size_t>(weight.link)];
        const Vector3d moment = first_moment(link, weight.mass, weight.moment);
        const auto rate = [&](Index e) { return rate_of(weight.mass, moment, twists.col(6 + e)); };
        const Vector3d rate_of_driven = rate(driven_);
        const Vector3d turned = rate_of_driven.cross(gravity_);
        value += gravity_.dot(rate_of_driven);
        for (Index i = 0; i < driven_; ++i) gradient[i] += w(i).dot(turned);
        for (Index i = driven_; i < weight.moved_by; ++i) gradient[i] += pull.dot(rate(i));
        for (Index i = 0; is_twice && i < weight.moved_by; ++i) {
            for (Index h = 0; h <= i; ++h) {
                std::array<Index, 3> order{h, i, driven_};
                std::sort(order.begin(), order.end());
                const double third =
                    gravity_.dot(w(order[0]).cross(w(order[1]).cross(rate(order[2]))));
                hessian(h, i) += third;
                if (h != i) hessian(i, h) += third;
            }
        }
    }
    TorqueShare share{value, arm_->driven_by().transpose() * gradient, {}};
    if (is_twice) share.hessian = arm_->driven_by().transpose() * hessian * arm_->driven_by();
    return share;
}

}  // namespace posewise
