#pragma once

#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::detail {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// Throws InputError if joint_repeatability has another size than the joints (and is not empty) or
/// a value that is negative or not finite, or if a model error is.
void check_noise(const Campaign& campaign);

/// Campaign::model_error_common; 0 where a pose shows one point or one body, which has nothing to
/// share with another; 1 for pixels.
double common_part(const Campaign& campaign);
/// Standard deviation of what a pose's targets share of the model error, m.
double common_model_error(const Campaign& campaign);
/// The motions of the flange that it consists of, each with that deviation: three translations
/// along the world's axes and three turns about them through the middle of the targets, scaled so
/// that a target at the RMS distance from the middle moves by 1 (RMS of a coordinate), half of its
/// square by each kind. Of a sensor of pixels they have the deviations Campaign::model_error and
/// model_error_orientation instead, about its point on the flange.
TwistMatrix model_error_twists(const Campaign& campaign, const Isometry3d& world_from_flange,
                               const VectorXd& sensor_unknowns);
/// The same in memory that is there.
void set_model_error_twists(const Campaign& campaign, const Isometry3d& world_from_flange,
                            const VectorXd& sensor_unknowns, TwistMatrix& twists);
/// Standard deviations of the model error that each of the sensor's rows has by itself, m or rad.
VectorXd own_model_errors(const Campaign& campaign);

/// Covariance of the mean observation of the targets seen at a pose, target j over repeats[j]
/// observations (0: not seen): the sensor's divided by repeats, plus what repeats do not reduce.
/// That is the model error, own_model_errors() and s^2 L L^T of common_model_error() s (L: the
/// observation's derivative by model_error_twists()), and J_q diag(r^2) J_q^T of the joints'
/// repeatability r (the robot stands still while it is observed again). Both motions correlate the
/// targets. Square, its rows those of seen_rows(), m^2.
MatrixXd mean_covariance(const Campaign& campaign, const FlangeMotion& motion,
                         const VectorXd& sensor_unknowns, const VectorXd& repeats);

/// The same with all targets seen equally often: sensor rows square.
MatrixXd mean_covariance(const Campaign& campaign, const FlangeMotion& motion,
                         const VectorXd& sensor_unknowns, double repeats);

/// Whether mean_covariance() is the same at every pose.
bool has_constant_noise(const Campaign& campaign);

/// Covariance C of the flange's motion that repeats do not reduce, of twists about the world's
/// origin: s^2 of model_error_twists() and r^2 of the joints' twists. What readings share is
/// A C A^T of mean_covariance(), A their derivative by such twists.
Matrix6d flange_covariance(const Campaign& campaign, const FlangeMotion& motion,
                           const VectorXd& sensor_unknowns);
/// Rate of flange_covariance() with one joint. `rate` is that joint's, as of
/// Chain::differentiate_twice().
Matrix6d flange_covariance_rate(const Campaign& campaign, const FlangeMotion& motion, Index joint,
                                const FlangeMotionRate& rate, const VectorXd& sensor_unknowns);

/// Multiplies `rows` from the left by L^-1, where covariance = L L^T (Cholesky): errors with this
/// covariance become independent with variance 1. Throws as cholesky_factor().
void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows);
/// The same in memory that the caller has: `factor` becomes L, or is left alone. Adds log det L to
/// `log_deviations`, if that is asked for.
void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows, MatrixXd& factor,
            double* log_deviations = nullptr);

/// The noise of one pose after another, in memory that it takes once; where it is the same at every
/// pose it is computed once, too.
class PoseNoise {
  public:
    explicit PoseNoise(const Campaign& campaign);

    /// mean_covariance() of a pose, until the next one is asked for.
    const MatrixXd& covariance(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                               const VectorXd& repeats);
    /// What it is without what flange_covariance() adds; covariance() ends it.
    const MatrixXd& own_covariance(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                                   const VectorXd& repeats);
    /// Which rows of a complete observation they are of.
    const std::vector<Index>& rows() const { return rows_; }

    /// Of `rows`, one for each number of a complete observation, takes those of the targets seen,
    /// whitened by the covariance(), to the front; returns how many they are.
    Index whiten_seen(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                      const VectorXd& repeats, Eigen::Ref<RowMatrixXd> rows);

    /// Reduces the same to a triangle, K^-1 R: the rows whitened by own_covariance() are Q R, and
    /// K K^T = with_flange_motion(R_6, flange_covariance()). The first six columns of `rows`, R_6
    /// of R, must be the observation's derivative by the flange's motions.
    RowMatrixXd triangle_of_seen(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                                 const VectorXd& repeats, Eigen::Ref<RowMatrixXd> rows);

  private:
    Index take_seen(Eigen::Ref<RowMatrixXd> rows) const;
    void add_effects(const FlangeMotion& motion, const VectorXd& sensor_unknowns);

    const Campaign& campaign_;
    double common_;           ///< common_model_error()
    VectorXd own_variances_;  ///< one a row of the sensor; so are the rows of what follows
    MatrixXd of_sensor_;
    TwistMatrix twists_;  ///< model_error_twists()
    RowMatrixXd effect_;  ///< by one standard deviation of each joint, then of each motion
    std::vector<Index> rows_;
    VectorXd repeats_;  ///< that rows_ and own_ are of
    MatrixXd own_;      ///< of rows_, as what follows
    MatrixXd covariance_;
    RowMatrixXd seen_effect_;
    MatrixXd factor_;
};

/// I + R_6 C R_6^T: covariance of numbers whose own errors are whitened, where R_6 is their
/// derivative by the flange's motions, which have the covariance C.
MatrixXd with_flange_motion(const Eigen::Ref<const MatrixXd>& R_6, const Matrix6d& C);

/// Before a product of columns and their transpose is added, which has that trace: where rounding
/// would leave nothing of the covariance, as beside a camera's lens, it counts as large as that.
void raise_to_rounding(MatrixXd& covariance, double trace);

/// L such that covariance = L L^T, for drawing noise. Throws InputError if the covariance is not
/// positive definite.
MatrixXd cholesky_factor(const MatrixXd& covariance);
void cholesky_factor(const MatrixXd& covariance, MatrixXd& L);

}  // namespace posewise::detail
