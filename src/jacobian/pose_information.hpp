#pragma once

#include <functional>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::detail {

class WhitenedPose;

/// What one pose tells about the parameters as a function of its joints: the information
/// B(q)^T B(q) of its block, whitened and scaled as by make_blocks(), and its derivative. Made once
/// for many configurations; every call is free of side effects, so threads may share one.
class PoseInformation {
  public:
    /// `campaign` is referred to and must outlive this. Throws InputError as check_noise() and
    /// parameter_scale() do, or if repeats is not positive and finite.
    PoseInformation(const Campaign& campaign, Parameters parameters, double repeats = 1);

    Index joint_count() const { return campaign_.robot.joint_count(); }
    Index parameter_count() const { return scale_.size(); }

    /// The block B: rows of the targets shown x parameter_count(), without units; at most 6 and one
    /// for each of the sensor's unknowns. `is_seen` are the targets that the pose shows; empty:
    /// all.
    RowMatrixXd rows(const VectorXd& q, const SeenTargets& is_seen = {}) const;

    /// B^T B: parameter_count() square, without units.
    MatrixXd evaluate(const VectorXd& q, const SeenTargets& is_seen = {}) const;

    /// Derivative of trace(Z B^T B) by the joints, for a symmetric Z (per rad or m). With Z the
    /// gradient of a criterion by the information matrix, this is the criterion's by this pose.
    VectorXd differentiate(const VectorXd& q, const MatrixXd& Z,
                           const SeenTargets& is_seen = {}) const;

    /// As differentiate(), for a Z that is not at hand: `weigh` takes B and returns B Z. It is
    /// called once.
    using Weigh = std::function<RowMatrixXd(const RowMatrixXd& B)>;
    VectorXd differentiate_weighed(const VectorXd& q, const Weigh& weigh,
                                   const SeenTargets& is_seen = {}) const;

  private:
    /// How often each target is observed; 0 where it is not seen.
    VectorXd repeats(const SeenTargets& is_seen) const;
    RowMatrixXd block(const WhitenedPose& pose, const FlangeMotion& motion) const;

    const Campaign& campaign_;
    Parameters parameters_;
    double repeats_;
    VectorXd scale_;
};

}  // namespace posewise::detail
