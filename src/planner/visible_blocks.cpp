#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/noise.hpp"
#include "posewise/planner/pool.hpp"

namespace posewise {
namespace {

/// Rows of an observation that belong to visible targets.
std::vector<Index> visible_rows(const std::vector<bool>& is_visible, Index row_count) {
    if (3 * static_cast<Index>(is_visible.size()) != row_count) {
        throw InputError("visibility is stated for " + std::to_string(is_visible.size()) +
                         " targets, the sensor has " + std::to_string(row_count / 3));
    }
    std::vector<Index> rows;
    for (Index row = 0; row < row_count; ++row) {
        if (is_visible[static_cast<std::size_t>(row / 3)]) rows.push_back(row);
    }
    return rows;
}

}  // namespace

Blocks make_visible_blocks(const Campaign& campaign, const Parameters& parameters,
                           const RowMatrixXd& configurations,
                           const std::vector<std::vector<bool>>& is_visible, double repeats) {
    if (is_visible.empty()) return make_blocks(campaign, parameters, configurations, repeats);
    const Index count = configurations.rows();
    if (static_cast<Index>(is_visible.size()) != count) {
        throw InputError("visibility is stated for " + std::to_string(is_visible.size()) +
                         " configurations, there are " + std::to_string(count));
    }
    check_noise(campaign);
    const Index row_count = campaign.sensor->row_count();
    std::vector<std::vector<Index>> rows;
    Blocks blocks;
    for (Index i = 0; i < count; ++i) {
        campaign.robot.check_configuration(configurations.row(i).transpose());
        rows.push_back(visible_rows(is_visible[static_cast<std::size_t>(i)], row_count));
        blocks.first_row.push_back(blocks.first_row.back() +
                                   static_cast<Index>(rows.back().size()));
    }
    const VectorXd scale = parameter_scale(campaign);
    blocks.matrix.resize(blocks.first_row.back(), scale.size());
#pragma omp parallel
    {
        FlangeMotion motion;
        RowMatrixXd J(row_count, scale.size());
#pragma omp for schedule(static)
        for (Index i = 0; i < count; ++i) {
            differentiate_pose(campaign, parameters, configurations.row(i).transpose(), motion, J);
            const auto& shown = rows[static_cast<std::size_t>(i)];
            // Hidden rows are left out before whitening: what is not observed has no covariance.
            RowMatrixXd B = J(shown, Eigen::all);
            const MatrixXd covariance =
                mean_covariance(campaign, motion, parameters.sensor, repeats)(shown, shown);
            whiten(covariance, B);
            blocks.matrix.middleRows(blocks.first_row[static_cast<std::size_t>(i)], B.rows()) =
                B * scale.asDiagonal();
        }
    }
    return blocks;
}

}  // namespace posewise
