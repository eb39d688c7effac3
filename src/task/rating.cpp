#include <Eigen/Cholesky>
#include <limits>

#include "posewise/calibrator/registration.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/inspection.hpp"

namespace posewise {
namespace {

/// Blocks, and below them what a prior tells: a root of its information of parameters that have
/// one.
MatrixXd stack_with_prior(const Blocks& blocks, const MatrixXd& prior) {
    std::vector<Index> known;
    for (Index k = 0; k < prior.rows(); ++k) {
        if (prior(k, k) > 0) known.push_back(k);
    }
    const MatrixXd root = MatrixXd(prior(known, known)).llt().matrixU();
    MatrixXd stacked = MatrixXd::Zero(blocks.matrix.rows() + root.rows(), blocks.parameter_count());
    stacked.topRows(blocks.matrix.rows()) = blocks.matrix;
    stacked.bottomRows(root.rows())(Eigen::all, known) = root;
    return stacked;
}

Indices compute_indices(const Blocks& blocks, const MatrixXd& stacked) {
    const VectorXd s = singular_values(stacked);
    const MatrixXd M = stacked.transpose() * stacked;
    Indices indices;
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        const Criterion criterion = all_criteria[i];
        indices.values[i] = needs_test_poses(criterion)
                                ? evaluate(criterion, M, blocks.count(), &blocks)
                                : evaluate(criterion, s, blocks.count());
    }
    const double least = s[s.size() - 1];
    indices.condition = least > 0 ? s[0] / least : std::numeric_limits<double>::infinity();
    return indices;
}

}  // namespace

Rating rate(const Campaign& campaign, const Measurements& measurements, Index directions) {
    const Parameters registered = determined(register_base_and_targets(campaign, measurements));
    Rating rating;
    rating.repeats = mean_repeats(measurements);
    const RowMatrixXd share = share_seen(measurements);
    const RowMatrixXd& configurations = measurements.configurations;
    const Blocks scaled = make_blocks(campaign, registered, configurations, rating.repeats * share);
    // m per m and m per rad are mm per mm and mm per mrad: nothing to convert.
    const Blocks plain = make_plain_blocks(campaign, registered, configurations, share);
    const MatrixXd stacked = stack_with_prior(scaled, prior_information(campaign));
    rating.configurations = scaled.count();
    rating.parameters = scaled.parameter_count();
    rating.scaled = compute_indices(scaled, stacked);
    rating.plain = compute_indices(plain, plain.matrix);
    rating.weakest = weakest_directions(stacked, directions);
    return rating;
}

}  // namespace posewise
