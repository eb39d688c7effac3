#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/prediction.hpp"
#include "unknowns.hpp"

namespace posewise {
namespace {

constexpr double coordinates = 3;

Index position_count(const PositionErrors& errors) {
    return errors.by_parameters.matrix.rows() / 3;
}

/// Mean square over the positions, m^2.
double mean_square(const MatrixXd& matrix, Index positions) {
    return matrix.squaredNorm() / static_cast<double>(positions);
}

double repeatability_square(const PositionErrors& errors) {
    return mean_square(errors.by_joints.matrix, position_count(errors));
}

PredictedAccuracy accuracy_of(const PositionErrors& errors, const Campaign& campaign,
                              const MatrixXd& M, const InformationByNoise& by_noise) {
    if (M.size() > 0) return predict_accuracy(errors.by_parameters, M, campaign, by_noise);
    PredictedAccuracy exact;
    exact.known_within = campaign.known_within;
    return exact;
}

/// Draws robots: how far each position is off, and what of that counts.
class RobotDraws {
  public:
    RobotDraws(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
               const InformationByNoise& by_noise, std::uint64_t seed)
        : errors_(errors),
          accuracy_(accuracy_of(errors, campaign, M, by_noise)),
          model_error_(campaign.model_error),
          seed_(seed) {
        if (M.size() == 0) return;
        // Error of a position = J0 dx with dx = L^-T z, M = L L^T.
        const Eigen::LLT<MatrixXd> cholesky(M);
        spread_ = cholesky.matrixL().solve(errors.by_parameters.matrix.transpose());
    }

    VectorXd draw(ErrorQuantity quantity) const {
        VectorXd drawn(block_count * robots_a_block);
        detail::for_each_index(block_count, [&](Index b) {
            RandomStream stream(seed_, static_cast<std::uint64_t>(b));
            const MatrixXd off = draw_block(b, stream);
            for (Index k = 0; k < robots_a_block; ++k) {
                VectorXd distances = off.col(k).reshaped(3, off.rows() / 3).colwise().norm();
                drawn[b * robots_a_block + k] =
                    quantity == ErrorQuantity::Max
                        ? distances.maxCoeff()
                        : quantile(std::move(distances), 0.95, detail::QuantileRule::Upper);
            }
        });
        return drawn;
    }

  private:
    static constexpr Index block_count = 32;
    static constexpr Index robots_a_block = 64;

    /// Errors of all positions (3 rows each) of the robots of block b, a column each.
    MatrixXd draw_block(Index b, RandomStream& stream) const {
        MatrixXd off = MatrixXd::Zero(errors_.by_parameters.matrix.rows(), robots_a_block);
        if (spread_.size() > 0) {
            MatrixXd z(spread_.rows(), robots_a_block);
            for (double& one : z.reshaped()) one = stream.normal();
            off = spread_.transpose() * z;
        }
        for (Index k = 0; k < robots_a_block; ++k) {
            const auto drawn = detail::draw_unknowns(
                b * robots_a_block + k, block_count * robots_a_block, accuracy_, model_error_);
            off.col(k) *= std::sqrt(drawn.growth);
            off.col(k) += model_error_ * drawn.model * stream.normals(off.rows());
            add_visits(off.col(k), stream);
        }
        return off;
    }

    void add_visits(Eigen::Ref<VectorXd> off, RandomStream& stream) const {
        const Blocks& joints = errors_.by_joints;
        for (Index i = 0; i < joints.count(); ++i) {
            const auto first = joints.first_row[static_cast<std::size_t>(i)];
            off.segment(first, joints[i].rows()) +=
                joints[i] * stream.normals(joints.parameter_count());
        }
    }

    const PositionErrors& errors_;
    PredictedAccuracy accuracy_;
    double model_error_;
    std::uint64_t seed_;
    MatrixXd spread_;
};

/// What each pose missing adds to the mean square.
class Losses {
  public:
    Losses(const Blocks& prediction, const MatrixXd& M) {
        const Eigen::LLT<MatrixXd> cholesky(M);
        if (cholesky.info() != Eigen::Success) {
            throw InputError("the poses do not identify all parameters, so none can be missing");
        }
        covariance_ = cholesky.solve(MatrixXd::Identity(M.rows(), M.cols()));
        const MatrixXd by_parameter = covariance_ * prediction.matrix.transpose();
        const auto positions = static_cast<double>(prediction.matrix.rows()) / 3;
        by_covariance_.setZero(M.rows(), M.cols());
        by_covariance_.selfadjointView<Eigen::Lower>().rankUpdate(by_parameter, 1 / positions);
        by_covariance_ = MatrixXd(by_covariance_.selfadjointView<Eigen::Lower>());
        square_ = (by_parameter.array() * prediction.matrix.transpose().array()).sum() / positions;
    }

    /// RMS without the pose of this block: M - B^T B inverted by Woodbury's identity.
    double rms_without(const RowMatrixXd& block) const {
        constexpr double least_left = 1e-8;  // of what is known of a direction
        const MatrixXd known = block * covariance_ * block.transpose();
        const MatrixXd left = MatrixXd::Identity(known.rows(), known.cols()) - known;
        const Eigen::LLT<MatrixXd> cholesky(left);
        if (cholesky.info() != Eigen::Success ||
            MatrixXd(cholesky.matrixL()).diagonal().minCoeff() < std::sqrt(least_left)) {
            return std::numeric_limits<double>::infinity();
        }
        const MatrixXd added = block * by_covariance_ * block.transpose();
        return std::sqrt(square_ + cholesky.solve(added).trace());
    }

  private:
    MatrixXd covariance_;
    MatrixXd by_covariance_;  // C B0^T B0 C / positions
    double square_ = 0;
};

}  // namespace

PositionErrors make_position_errors(const Campaign& campaign, const RowMatrixXd& workspace,
                                    Index target) {
    PositionErrors errors;
    errors.by_parameters = make_prediction_blocks(campaign, campaign.nominal, workspace, target);
    const VectorXd& repeatability = campaign.joint_repeatability;
    if (repeatability.size() == 0 || repeatability.isZero(0)) return errors;
    const Index all = 3 * campaign.sensor->target_count();
    const Index rows = target < 0 ? all : 3;
    const Index first = target < 0 ? 0 : 3 * target;
    Blocks& joints = errors.by_joints;
    joints.matrix.resize(rows * workspace.rows(), repeatability.size());
    FlangeMotion motion;
    RowMatrixXd J(all, repeatability.size());
    for (Index i = 0; i < workspace.rows(); ++i) {
        differentiate_flange(campaign, campaign.nominal, workspace.row(i).transpose(), motion);
        campaign.sensor->differentiate_positions(motion.world_from_flange, motion.joint_twists,
                                                 campaign.nominal.sensor, J);
        joints.matrix.middleRows(rows * i, rows) =
            J.middleRows(first, rows) * repeatability.asDiagonal();
        joints.first_row.push_back(rows * (i + 1));
    }
    return errors;
}

ErrorRange predict_range(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                         const InformationByNoise& by_noise, ErrorQuantity quantity,
                         double assurance, std::uint64_t seed) {
    if (!(assurance > 0 && assurance < 1)) {
        throw InputError("assurance is " + std::to_string(assurance) +
                         ", must be above 0 and below 1");
    }
    const auto range_of = [&](const VectorXd& cases) {
        const auto at = [&](double p) {
            return posewise::detail::quantile(cases, p, detail::QuantileRule::Linear);
        };
        return ErrorRange{at(0.5), at(0.05), at(0.95), at(assurance)};
    };
    if (quantity != ErrorQuantity::Rms) {
        return range_of(RobotDraws(errors, campaign, M, by_noise, seed).draw(quantity));
    }
    const PredictedAccuracy accuracy = accuracy_of(errors, campaign, M, by_noise);
    const double repeatability = repeatability_square(errors);
    const double model = campaign.model_error;
    ErrorRange range = range_of(total_cases(accuracy, model, std::sqrt(repeatability)));
    range.expected =
        std::sqrt(accuracy.rms * accuracy.rms + coordinates * model * model + repeatability);
    return range;
}

ErrorBudget make_budget(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                        const InformationByNoise& by_noise) {
    const PredictedAccuracy accuracy = accuracy_of(errors, campaign, M, by_noise);
    const double square = accuracy.rms * accuracy.rms;
    const double prior = accuracy.prior_share() * square;
    const double by_poses = std::max(0.0, square - prior);
    ErrorBudget budget;
    budget.parameters = accuracy.rms;
    budget.prior = std::sqrt(prior);
    budget.model = std::sqrt(accuracy.model_share * by_poses);
    budget.noise = std::sqrt((1 - accuracy.model_share) * by_poses);
    budget.left_over = std::sqrt(coordinates) * campaign.model_error;
    budget.repeatability = std::sqrt(repeatability_square(errors));
    budget.total = std::hypot(budget.parameters, budget.left_over, budget.repeatability);
    return budget;
}

std::vector<DropOut> drop_each(const Blocks& prediction, const Blocks& poses, const MatrixXd& M) {
    const Losses losses(prediction, M);
    std::vector<DropOut> drop_outs;
    for (Index i = 0; i < poses.count(); ++i) {
        drop_outs.push_back({i, losses.rms_without(poses[i])});
    }
    return drop_outs;
}

std::vector<DropOut> drop_worst(const Blocks& prediction, const Blocks& poses, Index count,
                                MatrixXd& M) {
    std::vector<DropOut> dropped;
    std::vector<bool> is_dropped(static_cast<std::size_t>(poses.count()), false);
    while (static_cast<Index>(dropped.size()) < std::min(count, poses.count())) {
        std::vector<DropOut> left = drop_each(prediction, poses, M);
        std::erase_if(left, [&](const DropOut& one) {
            return is_dropped[static_cast<std::size_t>(one.pose)];
        });
        const auto worst =
            std::max_element(left.begin(), left.end(),
                             [](const DropOut& a, const DropOut& b) { return a.rms < b.rms; });
        dropped.push_back(*worst);
        if (std::isinf(worst->rms)) return dropped;
        is_dropped[static_cast<std::size_t>(worst->pose)] = true;
        M -= poses[worst->pose].transpose() * poses[worst->pose];
    }
    return dropped;
}

}  // namespace posewise
