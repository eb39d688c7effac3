#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

class GravityTorque;

enum class Motion {
    Translation,  ///< along the axis, metres
    Rotation,     ///< about the axis, radians
};

/// The units of an amount of this motion.
constexpr const AmountUnits& units_of(Motion motion) {
    return units_of(motion == Motion::Rotation);
}

enum class Axis { X = 0, Y = 1, Z = 2 };

/// `coefficient * q[joint]`, one term of what drives an element. -1 is a reversed joint; a second
/// term in the same element is a coupling such as `q3 + q2`.
struct JointTerm {
    Index joint = 0;
    double coefficient = 1;
};

/// f(q) of an error that depends on the configuration, with u = phase + sum of joint terms. In
/// these terms, joint indices from the number of joints on are measured torques (see
/// Chain::torques()).
struct JointFunction {
    enum class Shape {
        Linear,  ///< u: joint coupling, transmission ratio, compliance under a measured torque
        Sine,    ///< sin(u); a cosine has phase pi/2
        Torque,  ///< torque of weights, divided by its largest value; times u if there are terms
    };
    Shape shape = Shape::Linear;
    std::vector<JointTerm> joints;
    double phase = 0;
    std::shared_ptr<const GravityTorque> torque = nullptr;  ///< for Shape::Torque
};

/// What a term models; this determines its expected size.
enum class TermKind {
    Free,      ///< written by hand; as large as a constant error
    Gravity,   ///< gravity torque on a compliant joint
    Harmonic,  ///< periodic error of an encoder, a gear, a slide's drive
    Torque,    ///< torque shape of unknown weights on a compliant joint
    Tilt,      ///< periodic tilt of a joint's axis as it turns
    Gain,      ///< scale of a slide, ratio of a gear: in proportion to the joint
};

/// An error that depends on the configuration: the element's amount gains parameter * f(q).
struct ErrorTerm {
    std::string parameter;  ///< name of the error parameter (rad or m, like the amount)
    JointFunction function;
    TermKind kind = TermKind::Free;
};

/// A known part of an element's amount that depends on the configuration: coefficient * f(q).
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

/// Name of the transform: "Tx" .. "Rz".
std::string transform_name(const Element& element);

/// A joint with its limits in rad (revolute) or m (prismatic).
struct Joint {
    std::string name;
    double lower = 0;
    double upper = 0;
    Motion motion = Motion::Rotation;  ///< motion of the elements it drives; set by Chain
    /// Of one that slides: how far it moves until the error of its drive repeats (lead of a screw,
    /// circumference of a pinion, pitch of a rack's teeth), m; 0: unknown.
    double pitch = 0;
};

/// A joint torque that is measured with each configuration.
struct MeasuredTorque {
    Index joint = 0;
    double largest = 1;  ///< largest magnitude that occurs, N m
};

/// The flange pose and its derivative by each parameter.
struct FlangeMotion {
    Isometry3d world_from_flange;
    /// 6 x (6 + R). Column k is the twist by parameter k (angular w; velocity v of the point at the
    /// world origin), so a point x fixed to the flange moves by v + w cross x. Columns 0-2 are
    /// translations of the base along the world axes, 3-5 its rotations about world axes through
    /// the base origin, the rest the chain's error parameters.
    TwistMatrix twists;
    /// 6 x joints: the twist by each joint, summed over the elements it drives.
    TwistMatrix joint_twists;
};

/// Derivative of the columns of a FlangeMotion by one joint.
struct FlangeMotionRate {
    TwistMatrix twists;        ///< 6 x (6 + R)
    TwistMatrix joint_twists;  ///< 6 x joints
};

/// A serial robot as a product of elementary transforms from base to flange:
/// base_from_flange(q) = prod_k E_k(v_k + c_k . q + pi_k + sum_i pi_ki f_ki(q)).
/// Error parameters are in the order of the elements; within an element the constant error comes
/// first, then its terms. A configuration q holds the joint values, then the measured torques (if
/// any).
class Chain {
  public:
    Chain() = default;
    Chain(const Chain&) = default;  // no move: a moved-from chain would have no parts
    Chain& operator=(const Chain&) = default;

    /// Throws InputError if a joint drives no element, or both a rotation and a translation; if its
    /// limits are not finite or out of order; if it turns and has a pitch, or one that is negative
    /// or not finite; if two parameters (or joints) share a name; if an
    /// element names a joint that does not exist or has a number that is not finite; if an error
    /// term has no name or no joint; or if a measured torque belongs to no revolute joint, to one
    /// that has another, or has a largest value that is not positive.
    Chain(std::vector<Joint> joints, std::vector<Element> elements,
          std::vector<MeasuredTorque> torques = {});

    /// A chain with the same joints and torques but other elements.
    Chain with_elements(std::vector<Element> elements) const;

    const std::vector<Joint>& joints() const { return parts_->joints; }
    const Joint& joint(Index index) const { return joints()[static_cast<std::size_t>(index)]; }
    const std::vector<MeasuredTorque>& torques() const { return parts_->torques; }
    const std::vector<Element>& elements() const { return parts_->elements; }
    Index joint_count() const { return static_cast<Index>(joints().size()); }
    /// Length of a configuration: joints and measured torques.
    Index configuration_size() const {
        return static_cast<Index>(joints().size() + torques().size());
    }
    Index parameter_count() const { return static_cast<Index>(parts_->parameter_places.size()); }

    /// The element that carries error parameter k.
    const Element& parameter_element(Index parameter) const;
    /// The term that carries error parameter k; nullptr if it is an element's constant error.
    const ErrorTerm* parameter_term(Index parameter) const;
    std::vector<std::string> parameter_names() const;

    /// Throws InputError (naming the joint, value and rule) if q has the wrong size or a value that
    /// is not finite. Does not check limits.
    void check_configuration(const VectorXd& q) const;

    /// base_from_flange at q (configuration_size(); rad or m, then N m) and error parameters
    /// (parameter_count(), rad or m; zero is nominal).
    Isometry3d base_from_flange(const VectorXd& q, const VectorXd& parameters) const;

    /// base_from_flange() of many configurations (m x configuration_size()), with the same digits
    /// but faster: several at a time, and constant parts only once.
    std::vector<Isometry3d> base_from_flanges(const RowMatrixXd& configurations,
                                              const VectorXd& parameters) const;

    /// Frames of all links for the same arguments, joint_count() + 2 of them: [0] is the base, [j]
    /// is right after the first element that joint j (counting from 1) drives, the last one is the
    /// flange.
    std::vector<Isometry3d> base_from_links(const VectorXd& q, const VectorXd& parameters) const;

    /// Flange pose in the world and its twist by every parameter, in one pass over the elements. A
    /// rotation contributes (axis; origin cross axis), a translation (0; axis), both taken from the
    /// running product. `motion` is resized only if needed, so reusing it avoids allocation.
    /// Without `by_joints`, its joint_twists have no columns.
    void differentiate(const Isometry3d& world_from_base, const VectorXd& q,
                       const VectorXd& parameters, FlangeMotion& motion,
                       bool by_joints = true) const;

    /// As differentiate(); in addition, rates[j] is the rate by joint j. An element's twist changes
    /// only with the elements before it, by the Lie bracket of theirs with it; the base's columns
    /// are constant. Like `motion`, `rates` is resized only if needed.
    void differentiate_twice(const Isometry3d& world_from_base, const VectorXd& q,
                             const VectorXd& parameters, FlangeMotion& motion,
                             std::vector<FlangeMotionRate>& rates) const;

  private:
    /// Place of an error parameter: an element, and one of its terms (-1: its constant error).
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

    std::shared_ptr<const Parts> parts_ = std::make_shared<Parts>();  ///< shared by copies
};

/// For each element, the joint whose errors it carries (-1: none): the first of its joints that no
/// earlier element carries.
std::vector<Index> element_owners(const Chain& chain);

/// That of the element of an error parameter.
Index parameter_owner(const Chain& chain, Index parameter);

/// The robot without error parameters: a calibration then fits only base and targets.
Chain without_parameters(const Chain& chain);

/// Makes the known errors of a robot, with these values (parameter_count(), m and rad), part of its
/// elements. The other errors remain parameters, in their order.
Chain with_known_errors(const Chain& chain, const VectorXd& values,
                        const std::vector<bool>& is_known);

// Constant transforms, and joints about any axis, as elementary transforms.

/// Rz(yaw) Ry(pitch) Rx(roll) for (roll, pitch, yaw): rotations about the fixed x, y and z axes,
/// rad.
Matrix3d rotation_from_rpy(const Vector3d& rpy);

/// Rotation about `vector` by its norm, rad.
Matrix3d rotation_from_vector(const Vector3d& vector);

/// Rotation vector of a rotation matrix, with norm at most pi.
Vector3d vector_from_rotation(const Matrix3d& R);

/// Rotation nearest to a matrix (least squares), by its singular values.
Matrix3d nearest_rotation(const Matrix3d& X);

/// The smallest rotation that turns the direction of `from` into that of `to`; of opposite ones,
/// one of those by 180 deg.
Matrix3d rotation_between(const Vector3d& from, const Vector3d& to);

/// Left Jacobian of SO(3) [Barfoot 2017, (7.77)]: while a rotation vector changes at the rate r,
/// its rotation has the angular velocity (this matrix) r.
Matrix3d rotation_vector_rate(const Vector3d& vector);

/// [vector]x, the matrix of the cross product with it.
Matrix3d cross_matrix(const Vector3d& vector);

/// (roll, pitch, yaw) of a rotation matrix, pitch within +-pi/2. They reproduce the matrix to
/// rounding, even with the pitch so near +-pi/2 that roll and yaw are one turn.
Vector3d rpy_from_rotation(const Matrix3d& R);

/// A constant transform as Tx Ty Tz Rz Ry Rx; those that do nothing are omitted.
std::vector<Element> origin_elements(const Vector3d& xyz, const Vector3d& rpy);

/// A joint about or along a unit vector. The nearest coordinate axis is rotated into the vector,
/// the joint drives an element on that axis (reversed if the vector points against it), and the
/// frame is rotated back: at most Ri Rj E(+-q) Rj Ri. A vector along a coordinate axis needs one
/// element.
std::vector<Element> joint_elements(Motion motion, const Vector3d& axis, Index joint);

/// Largest difference between the flange poses of two robots.
struct FlangeDifference {
    double position = 0;     ///< m
    double orientation = 0;  ///< rad
    Index configuration_count = 0;
};

/// Compares random configurations within the limits of `a`; the i-th comes from stream (seed, i).
/// Error parameters are as for Chain::base_from_flange(). Joints are matched by name. The robots
/// need not measure the same torques; those of `b` are zero. Throws InputError if `b` has other
/// joints.
FlangeDifference compare_flanges(const Chain& a, const VectorXd& parameters_a, const Chain& b,
                                 const VectorXd& parameters_b, Index configuration_count = 1000,
                                 std::uint64_t seed = 1);

}  // namespace posewise
