#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "measurement/noise.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
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

/// RMS that the model error adds.
double left_over_of(const PositionErrors& errors) {
    return std::sqrt(mean_square(errors.by_model.matrix, position_count(errors)) +
                     coordinates * errors.own_error * errors.own_error);
}

/// M may be empty: parameters are known exactly.
PredictedAccuracy accuracy_of(const PositionErrors& errors, const Campaign& campaign,
                              const MatrixXd& M, const InformationByNoise& by_noise) {
    if (M.size() > 0) return predict_accuracy(errors, M, campaign, by_noise);
    PredictedAccuracy exact;
    exact.known_within = campaign.known_within;
    exact.left_over = left_over_of(errors);
    return exact;
}

/// Draws robots: how far each position is off, and what of that counts.
class RobotDraws {
  public:
    RobotDraws(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
               const InformationByNoise& by_noise, std::uint64_t seed)
        : errors_(errors), accuracy_(accuracy_of(errors, campaign, M, by_noise)), seed_(seed) {
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
            const auto drawn = detail::draw_unknowns(b * robots_a_block + k,
                                                     block_count * robots_a_block, accuracy_);
            off.col(k) *= std::sqrt(drawn.growth);
            off.col(k) += errors_.own_error * drawn.model * stream.normals(off.rows());
            add_draws(errors_.by_model, drawn.model, off.col(k), stream);
            add_draws(errors_.by_joints, 1, off.col(k), stream);
        }
        return off;
    }

    /// What each configuration has of its own draw.
    static void add_draws(const Blocks& effects, double times, Eigen::Ref<VectorXd> off,
                          RandomStream& stream) {
        for (Index i = 0; i < effects.count(); ++i) {
            const auto first = effects.first_row[static_cast<std::size_t>(i)];
            off.segment(first, effects[i].rows()) +=
                times * (effects[i] * stream.normals(effects.parameter_count()));
        }
    }

    const PositionErrors& errors_;
    PredictedAccuracy accuracy_;
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
    const Index all = 3 * campaign.sensor->position_count();
    const Index rows = target < 0 ? all : 3;
    const Index first = target < 0 ? 0 : 3 * target;
    const auto add = [&](Blocks& effects, const VectorXd& sizes, auto twists_of) {
        if (sizes.isZero(0)) return;
        effects.matrix.resize(rows * workspace.rows(), sizes.size());
        FlangeMotion motion;
        RowMatrixXd J(all, sizes.size());
        for (Index i = 0; i < workspace.rows(); ++i) {
            differentiate_flange(campaign, campaign.nominal, workspace.row(i).transpose(), motion);
            campaign.sensor->differentiate_positions(motion.world_from_flange, twists_of(motion),
                                                     campaign.nominal.sensor, J);
            effects.matrix.middleRows(rows * i, rows) =
                J.middleRows(first, rows) * sizes.asDiagonal();
            effects.first_row.push_back(rows * (i + 1));
        }
    };
    add(errors.by_joints, campaign.joint_repeatability,
        [](const FlangeMotion& motion) { return motion.joint_twists; });
    add(errors.by_model, VectorXd::Constant(6, detail::common_model_error(campaign)),
        [&](const FlangeMotion& motion) {
            return detail::model_error_twists(campaign, motion.world_from_flange,
                                              campaign.nominal.sensor);
        });
    errors.own_error = std::sqrt(1 - detail::common_part(campaign)) * campaign.model_error;
    return errors;
}

PredictedAccuracy predict_accuracy(const PositionErrors& errors, const MatrixXd& M,
                                   const Campaign& campaign, const InformationByNoise& by_noise) {
    PredictedAccuracy accuracy =
        predict_accuracy(errors.by_parameters, M, prior_information(campaign));
    accuracy.left_over = left_over_of(errors);
    accuracy.known_within = campaign.known_within;
    const MatrixXd by_parameter = M.llt().solve(errors.by_parameters.matrix.transpose());
    const auto square_by = [&](const MatrixXd& information) {
        return by_parameter.cwiseProduct(information * by_parameter).sum();
    };
    const double model = square_by(by_noise.model);
    const double noise = square_by(by_noise.noise);
    accuracy.model_share = model + noise > 0 ? model / (model + noise) : 0;
    return accuracy;
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
    ErrorRange range = range_of(total_cases(accuracy, std::sqrt(repeatability)));
    range.expected = std::hypot(accuracy.rms, accuracy.left_over, std::sqrt(repeatability));
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
    budget.left_over = left_over_of(errors);
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
