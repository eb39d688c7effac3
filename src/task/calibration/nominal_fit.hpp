#pragma once

#include "posewise/task/inspection.hpp"

namespace posewise::detail {

/// How the robot found differs from the one that its maker says.
struct NominalFit {
    RowMatrixXd configurations;  ///< of the workspace
    /// By how much each target is elsewhere, m: 3 numbers of each at each configuration.
    VectorXd displacements;
};

/// Base and targets of the robot as its maker says are fitted to the targets of the one found, as
/// far as they are not known. Throws InputError as estimated_geometry() does.
NominalFit fit_nominal(const Campaign& campaign, const Parameters& found,
                       const GeometryOptions& options);

}  // namespace posewise::detail
