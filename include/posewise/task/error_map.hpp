#pragma once

#include <optional>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/geometry.hpp"
#include "posewise/task/planning.hpp"

/// Where in its workspace a robot will be how accurate.
namespace posewise {

/// One configuration.
struct MappedError {
    VectorXd configuration;                ///< rad or m (and N m of measured torques)
    Vector3d position = Vector3d::Zero();  ///< of the first target, in the world, m
    double predicted = 0;                  ///< RMS of targets' position errors by the parameters, m
    std::optional<Vector3d> displacement{};  ///< of the first target, m; see map_errors()
};
using ErrorMap = std::vector<MappedError>;

/// Of the plan that make_plan() made with these options, over its workspace and the target that
/// counts: the RMS of all is that of Plan::predicted. Throws InputError as make_plan(), and where
/// the poses do not identify the parameters.
ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

/// Of a choice of choose(), over as many of its candidates as Plan::predicted is.
ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options);

/// Of a calibrated robot, over a workspace as estimated_geometry() draws it. The displacement is by
/// how much the robot found has its first target elsewhere than the robot as its maker says, whose
/// base and targets are fitted over the workspace as far as they are not known. Throws InputError
/// as estimated_geometry().
ErrorMap map_errors(const Campaign& campaign, const Estimate& estimate,
                    const GeometryOptions& options = {{}, 500});

}  // namespace posewise
