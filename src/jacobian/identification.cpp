#include "posewise/jacobian/identification.hpp"

#include "posewise/measurement/noise.hpp"

namespace posewise {
namespace {

Blocks make_unfilled_blocks(const Campaign& campaign, const RowMatrixXd& configurations) {
    for (Index i = 0; i < configurations.rows(); ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
    }
    check_noise(campaign);
    const Index rows = campaign.sensor->row_count();
    Blocks blocks;
    blocks.matrix.resize(rows * configurations.rows(), parameter_count(campaign));
    for (Index i = 1; i <= configurations.rows(); ++i) blocks.first_row.push_back(rows * i);
    return blocks;
}

/// Fills every pose's rows, then lets `finish(motion, rows)` whiten and scale them.
template <typename Finish>
void fill(const Campaign& campaign, const Parameters& parameters, const RowMatrixXd& configurations,
          Blocks& blocks, const Finish& finish) {
    const Index rows = campaign.sensor->row_count();
#pragma omp parallel
    {
        FlangeMotion motion;
        VectorXd q(configurations.cols());
#pragma omp for schedule(static)
        for (Index i = 0; i < configurations.rows(); ++i) {
            q = configurations.row(i).transpose();
            auto J = blocks.matrix.middleRows(rows * i, rows);
            differentiate_pose(campaign, parameters, q, motion, J);
            finish(motion, J);
        }
    }
}

}  // namespace

void differentiate_pose(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd& configuration, FlangeMotion& motion,
                        Eigen::Ref<RowMatrixXd> J_measured_parameters) {
    campaign.robot.differentiate(parameters.world_from_base, configuration, parameters.robot,
                                 motion);
    campaign.sensor->differentiate(motion.world_from_flange, motion.twists, parameters.sensor,
                                   J_measured_parameters);
}

Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations) {
    Blocks blocks = make_unfilled_blocks(campaign, configurations);
    fill(campaign, parameters, configurations, blocks, [](const auto&, auto&) {});
    return blocks;
}

Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats) {
    Blocks blocks = make_unfilled_blocks(campaign, configurations);
    const VectorXd scale = parameter_scale(campaign);
    fill(campaign, parameters, configurations, blocks, [&](const FlangeMotion& motion, auto& J) {
        whiten(mean_covariance(campaign, motion, parameters.sensor, repeats), J);
        J *= scale.asDiagonal();
    });
    return blocks;
}

}  // namespace posewise
