#pragma once

#include <memory>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/core/units.hpp"

namespace posewise {

class GravityTorque;

enum class Motion {
    Translation,  ///< along the axis, metres
    Rotation,     ///< about the axis, radians
};

/// The units that amounts of this motion are stated in.
constexpr const AmountUnits& units_of(Motion motion) {
    return units_of(motion == Motion::Rotation);
}

enum class Axis { X = 0, Y = 1, Z = 2 };

/// `coefficient * q[joint]`, part of what drives an element. -1 is a reversed joint; a second term
/// in the same element is a coupling such as `q3 + q2`.
struct JointTerm {
    Index joint = 0;
    double coefficient = 1;
};

/// f(q) of an error that depends on the configuration; u = phase + sum of joint terms. Of such a
/// term a joint index from the number of joints on is a measured torque (see Chain::torques()).
struct JointFunction {
    enum class Shape {
        Linear,  ///< u: coupling of joints, transmission ratio, compliance under a measured torque
        Sine,    ///< sin(u); a cosine has phase pi/2
        Torque,  ///< the torque of known weights, as a share of the largest; no joint terms
    };
    Shape shape = Shape::Linear;
    std::vector<JointTerm> joints;
    double phase = 0;
    std::shared_ptr<const GravityTorque> torque = nullptr;  ///< of Shape::Torque
};

/// What a term is for, which says how large it is expected to be.
enum class TermKind {
    Free,      ///< written by hand; as large as a constant error
    Gravity,   ///< torque of the weight on a compliant joint
    Harmonic,  ///< periodic error of an encoder or a gear
    Torque,    ///< shape of the torque that unknown weights put on a compliant joint
    Tilt,      ///< periodic tilt of a joint's axis as it turns
};

/// An error of an element that depends on the configuration: its amount gains parameter * f(q).
struct ErrorTerm {
    std::string parameter;  ///< name of the error parameter, in rad or m as the element's amount
    JointFunction function;
    TermKind kind = TermKind::Free;
};

/// A part of an element's amount that depends on the configuration and is known: coefficient *
/// f(q).
struct KnownTerm {
    JointFunction function;
    double coefficient = 0;  ///< rad or m
};

/// One elementary transform
/// E(value + sum of joint terms + known terms + error parameter + sum of error terms).
struct Element {
    Motion motion = Motion::Translation;
    Axis axis = Axis::X;
    double value = 0;                   ///< nominal, m or rad
    std::vector<JointTerm> joints;      ///< empty: a fixed element
    std::string parameter = {};         ///< name of its constant error; empty: none
    std::vector<ErrorTerm> terms = {};  ///< errors that depend on the configuration
    std::vector<KnownTerm> known_terms = {};

    bool has_functions() const { return !terms.empty() || !known_terms.empty(); }
};

/// "Tx" .. "Rz".
std::string transform_name(const Element& element);

/// A joint with its limits in rad (revolute) or m (prismatic).
struct Joint {
    std::string name;
    double lower = 0;
    double upper = 0;
    Motion motion = Motion::Rotation;  ///< that of the elements it drives; set by Chain
};

/// A joint's torque that is measured with each configuration.
struct MeasuredTorque {
    Index joint = 0;
    double largest = 1;  ///< that occurs, in magnitude, N m
};

/// Where the flange is, and how it moves with each parameter.
struct FlangeMotion {
    Isometry3d world_from_flange;
    /// 6 x (6 + R). Column k is the twist (angular w; velocity v of the point at the world origin)
    /// by parameter k, so a point x fixed to the flange moves by v + w cross x. Columns 0-2 are
    /// translations of the base along the world axes, 3-5 its rotations about world axes through
    /// the base origin, the rest the chain's error parameters.
    TwistMatrix twists;
    /// 6 x joints: the twist by each joint, whatever elements it drives.
    TwistMatrix joint_twists;
};

/// How the columns of a FlangeMotion change with one joint.
struct FlangeMotionRate {
    TwistMatrix twists;        ///< 6 x (6 + R)
    TwistMatrix joint_twists;  ///< 6 x joints
};

/// A serial robot as a product of elementary transforms from base to flange:
/// base_from_flange(q) = prod_k E_k(v_k + c_k . q + pi_k + sum_i pi_ki f_ki(q)). Error parameters
/// stand in the order of the elements, of one element first its constant error, then its terms.
/// A configuration q is the joint values, then the torques measured with them (if any).
class Chain {
  public:
    Chain() = default;
    Chain(const Chain&) = default;  // moved from it would have no parts
    Chain& operator=(const Chain&) = default;

    /// Throws InputError if a joint drives no element or both a rotation and a translation, if its
    /// limits are not finite or out of order, if two parameters (or joints) share a name, if an
    /// element names a joint that does not exist or has a number that is not finite, if an error
    /// term has no name or no joint, or if a torque is of no joint that turns, of one twice, or not
    /// positive at its largest.
    Chain(std::vector<Joint> joints, std::vector<Element> elements,
          std::vector<MeasuredTorque> torques = {});

    /// The same joints and torques with other elements.
    Chain with_elements(std::vector<Element> elements) const;

    const std::vector<Joint>& joints() const { return parts_->joints; }
    const Joint& joint(Index index) const { return joints()[static_cast<std::size_t>(index)]; }
    const std::vector<MeasuredTorque>& torques() const { return parts_->torques; }
    const std::vector<Element>& elements() const { return parts_->elements; }
    Index joint_count() const { return static_cast<Index>(joints().size()); }
    /// Numbers of a configuration: joints and measured torques.
    Index configuration_size() const {
        return static_cast<Index>(joints().size() + torques().size());
    }
    Index parameter_count() const { return static_cast<Index>(parts_->parameter_places.size()); }

    /// The element that carries error parameter k.
    const Element& parameter_element(Index parameter) const;
    /// The term whose error parameter k is; nullptr if it is an element's constant error.
    const ErrorTerm* parameter_term(Index parameter) const;
    std::vector<std::string> parameter_names() const;

    /// Throws InputError (naming the joint, value and rule) if q has the wrong size or a value
    /// that is not finite. Limits are not looked at.
    void check_configuration(const VectorXd& q) const;

    /// base_from_flange at q (configuration_size(); rad or m, then N m) and error parameters
    /// (parameter_count(), rad or m; zero is nominal).
    Isometry3d base_from_flange(const VectorXd& q, const VectorXd& parameters) const;

    /// The same of many configurations (m x configuration_size()), to the same digits but more
    /// quickly: several at a time, and what does not depend on them once.
    std::vector<Isometry3d> base_from_flanges(const RowMatrixXd& configurations,
                                              const VectorXd& parameters) const;

    /// Frames of all links at the same arguments, joint_count() + 2 of them: [0] the base itself,
    /// [j] right after the first element that joint j (counting from 1) drives, the last one the
    /// flange.
    std::vector<Isometry3d> base_from_links(const VectorXd& q, const VectorXd& parameters) const;

    /// Flange pose in the world and its twist by every parameter, in one pass over the elements:
    /// a rotation contributes (axis; origin cross axis), a translation (0; axis), both read off
    /// the running product. `motion` is resized at need only, so a reused one costs no allocation.
    /// Without `by_joints` its joint_twists have no columns.
    void differentiate(const Isometry3d& world_from_base, const VectorXd& q,
                       const VectorXd& parameters, FlangeMotion& motion,
                       bool by_joints = true) const;

    /// The same, and rates[j] by joint j. The twist of an element changes only with the elements
    /// before it, by the Lie bracket of theirs with it; the base's columns do not change. As
    /// `motion`, `rates` is resized at need only.
    void differentiate_twice(const Isometry3d& world_from_base, const VectorXd& q,
                             const VectorXd& parameters, FlangeMotion& motion,
                             std::vector<FlangeMotionRate>& rates) const;

  private:
    /// Where an error parameter stands: an element, and one of its terms (-1: its constant error).
    struct Place {
        Index element;
        Index term;
    };

    template <typename Visit>
    void walk(const Isometry3d& world_from_base, const VectorXd& q, const VectorXd& parameters,
              FlangeMotion& motion, bool by_joints, const Visit& visit) const;

    struct Parts {
        std::vector<Joint> joints;
        std::vector<Element> elements;
        std::vector<MeasuredTorque> torques;
        std::vector<Place> parameter_places;
    };

    std::shared_ptr<const Parts> parts_ = std::make_shared<Parts>();  ///< copies share them
};

/// For each element the joint whose errors it carries, -1 if none's: the first of its joints that
/// no element before it carries.
std::vector<Index> element_owners(const Chain& chain);

/// The same robot without error parameters: calibrating it fits base and targets only.
Chain without_parameters(const Chain& chain);

/// The robot with these values (parameter_count(), m and rad) of the errors that are known taken
/// for parts of its elements; the others stay error parameters, in their order.
Chain with_known_errors(const Chain& chain, const VectorXd& values,
                        const std::vector<bool>& is_known);

}  // namespace posewise
