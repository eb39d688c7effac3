#include <array>
#include <cmath>

#include "core/decompositions.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/inspection.hpp"
#include "task/calibration/nominal_fit.hpp"
#include "task/plan/workspace.hpp"

namespace posewise {
namespace {

using namespace detail;

/// An error as large as is expected must bring the positions this much nearer to be worth it, m
/// RMS.
constexpr double change_weight = 1e-6;

RowMatrixXd draw_configurations(const Campaign& campaign, const Parameters& found,
                                const GeometryOptions& options) {
    if (options.workspace.rows() > 0) {
        for (Index i = 0; i < options.workspace.rows(); ++i) {
            campaign.robot.check_configuration(options.workspace.row(i).transpose());
        }
        return options.workspace;
    }
    return workspace_configurations(campaign, found, options.configuration_count, options.seed);
}

std::vector<Vector3d> target_positions(const Campaign& campaign, const Parameters& parameters) {
    std::vector<Vector3d> positions;
    const Targets& targets = campaign.sensor->targets();
    for (Index target = 0; target < targets.count(); ++target) {
        positions.push_back(targets.position(target, parameters.sensor));
    }
    return positions;
}

/// The tool in the flange frame, of sensors that measure its pose.
std::optional<Isometry3d> tool_of(const Campaign& campaign, const Parameters& parameters) {
    if (!campaign.sensor->has_orientation()) return std::nullopt;
    const VectorXd pose = campaign.sensor->predict(Isometry3d::Identity(), parameters.sensor);
    Isometry3d tool = Isometry3d::Identity();
    tool.translation() = pose.head<3>();
    tool.linear() = rotation_from_vector(pose.tail<3>());
    return tool;
}

/// Of points on the flange, in the world: 3 coordinates of each at each configuration.
VectorXd predict_positions(const Campaign& campaign, const Parameters& parameters,
                           const std::vector<Vector3d>& points, const RowMatrixXd& configurations) {
    VectorXd positions(3 * configurations.rows() * std::ssize(points));
    Index row = 0;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const Isometry3d flange =
            world_from_flange(campaign, parameters, configurations.row(i).transpose());
        for (const Vector3d& point : points) {
            positions.segment<3>(row) = flange * point;
            row += 3;
        }
    }
    return positions;
}

PositionLoss loss_of(const VectorXd& difference) {
    const VectorXd distances = difference.reshaped(3, difference.size() / 3).colwise().norm();
    return {std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
            distances.maxCoeff()};
}

/// Points on the flange as a sensor that knows some of their coordinates, and all of these.
struct FlangePoints {
    std::vector<Vector3d> positions;  ///< m
    std::vector<std::array<bool, 3>> is_known;

    /// The unknown ones, in the sensor's order.
    VectorXd unknowns(const Targets& targets) const {
        VectorXd values(targets.unknown_count());
        for (Index point = 0; point < targets.count(); ++point) {
            for (Index axis = 0; axis < 3; ++axis) {
                const Index k = targets.unknown_index(point, axis);
                if (k >= 0) values[k] = positions[static_cast<std::size_t>(point)][axis];
            }
        }
        return values;
    }
};

/// Of each target.
std::vector<std::array<bool, 3>> known_axes(const Campaign& campaign) {
    const Targets& targets = campaign.sensor->targets();
    std::vector<std::array<bool, 3>> known;
    for (Index target = 0; target < targets.count(); ++target) {
        auto& is_known = known.emplace_back();
        for (Index axis = 0; axis < 3; ++axis) {
            is_known[static_cast<std::size_t>(axis)] = targets.unknown_index(target, axis) < 0;
        }
    }
    return known;
}

constexpr double lever = 0.1;  // m

/// What is fitted: the targets, with points beside them if they are few.
FlangePoints fitted_points(const Campaign& campaign, const Parameters& found) {
    const Targets& targets = campaign.sensor->targets();
    FlangePoints points{target_positions(campaign, found), known_axes(campaign)};
    if (targets.count() < 3) {
        for (Index axis = 0; axis < 3; ++axis) {
            points.positions.emplace_back(points.positions.front() + lever * Vector3d::Unit(axis));
            points.is_known.push_back(points.is_known.front());
        }
    }
    return points;
}

/// The tool, turned as the points beside the first target were in the fit.
std::optional<Isometry3d> turned_tool(const std::optional<Isometry3d>& tool,
                                      const std::vector<Vector3d>& fitted) {
    if (!tool) return std::nullopt;
    Matrix3d axes;
    for (Index axis = 0; axis < 3; ++axis) {
        axes.col(axis) = (fitted[static_cast<std::size_t>(axis) + 1] - fitted.front()) / lever;
    }
    Isometry3d turned = *tool;
    turned.translation() = fitted.front();
    turned.linear() = nearest_rotation(axes) * tool->linear();
    return turned;
}

/// The robot with the constant errors found as parts of its elements, but for those behind the last
/// joint: they are the targets' as long as these are unknown.
Chain with_constant_errors(const Chain& robot, const VectorXd& errors) {
    const Element* last_driven = nullptr;
    for (const Element& element : robot.elements()) {
        if (!element.joints.empty()) last_driven = &element;
    }
    std::vector<bool> is_known;
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        is_known.push_back(robot.parameter_term(k) == nullptr &&
                           &robot.parameter_element(k) <= last_driven);
    }
    return without_parameters(without_terms(with_known_errors(robot, errors, is_known)));
}

/// The campaign whose calibration on the positions of `points` is the nearest geometry of a robot;
/// base and targets are nominally those found.
Campaign geometric_campaign(const Campaign& campaign, const Chain& robot, const Parameters& found,
                            const FlangePoints& points) {
    Campaign geometric = with_robot(campaign, robot);
    geometric.prior.reset();
    geometric.joint_repeatability.resize(0);
    geometric.spread = population_spread(geometric.robot);
    geometric.sensor = std::make_shared<PointSensor>(Targets(points.positions, points.is_known),
                                                     PointNoise(IsotropicNoise{change_weight}));
    geometric.nominal.world_from_base = found.world_from_base;
    geometric.nominal.sensor = points.unknowns(geometric.sensor->targets());
    geometric.has_nominal_base = geometric.has_nominal_targets = true;
    return geometric;
}

/// Least squares: |J d - r|^2 of a step d, rows: positions, changes of the robot's errors.
struct Equations {
    MatrixXd J;
    VectorXd r;
};

Equations equations(const Campaign& geometric, const Parameters& parameters,
                    const RowMatrixXd& configurations, const VectorXd& wanted) {
    const Blocks blocks = make_position_blocks(geometric, parameters, configurations);
    const Index rows = blocks.matrix.rows();
    const Index begin = base_parameter_count(geometric);
    const Index count = geometric.robot.parameter_count();
    Equations system{MatrixXd::Zero(rows + count, blocks.matrix.cols()), VectorXd(rows + count)};
    const double weight = change_weight * std::sqrt(static_cast<double>(rows) / 3);
    const VectorXd weights =
        weight * parameter_scale(geometric).segment(begin, count).cwiseInverse();
    system.J.topRows(rows) = blocks.matrix;
    system.J.bottomRows(count).middleCols(begin, count).diagonal() = weights;
    system.r << wanted - predict_positions(geometric, parameters,
                                           target_positions(geometric, parameters), configurations),
        -weights.cwiseProduct(parameters.robot);
    return system;
}

/// Gauss-Newton from what was found: the model is nearly linear over the errors of a robot.
Parameters fit(const Campaign& geometric, const RowMatrixXd& configurations,
               const VectorXd& wanted) {
    constexpr Index iteration_limit = 20;
    constexpr double tolerance = 1e-9;  // relative fall of the sum of squares
    Parameters best = geometric.nominal;
    if (parameter_count(geometric) == 0) return best;
    Equations system = equations(geometric, best, configurations, wanted);
    for (Index k = 0; k < iteration_limit; ++k) {
        const Parameters next = advance(geometric, best, solve_least_squares(system.J, system.r));
        Equations moved = equations(geometric, next, configurations, wanted);
        const double before = system.r.squaredNorm();
        if (moved.r.squaredNorm() < before) {
            best = next;
            system = std::move(moved);
        }
        if (system.r.squaredNorm() >= (1 - tolerance) * before) break;
    }
    return best;
}

}  // namespace

Geometry estimated_geometry(const Campaign& campaign, const Parameters& found,
                            const GeometryOptions& options) {
    std::vector<Index> constants;
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        if (campaign.robot.parameter_term(k) == nullptr) constants.push_back(k);
    }
    Geometry geometry{without_terms(campaign.robot), found.robot(constants),
                      found.world_from_base,         target_positions(campaign, found),
                      tool_of(campaign, found),      {}};
    const RowMatrixXd configurations = draw_configurations(campaign, found, options);
    const Parameters constant{found.world_from_base, geometry.errors, found.sensor};
    geometry.lost = loss_of(predict_positions(with_robot(campaign, geometry.robot), constant,
                                              geometry.targets, configurations) -
                            predict_positions(campaign, found, geometry.targets, configurations));
    return geometry;
}

Geometry nearest_geometry(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options) {
    const RowMatrixXd configurations = draw_configurations(campaign, found, options);
    const FlangePoints points = fitted_points(campaign, found);
    Campaign geometric = geometric_campaign(
        campaign, with_constant_errors(campaign.robot, found.robot), found, points);
    geometric = with_robot(geometric, irreducible_model(geometric));
    const Parameters nearest =
        fit(geometric, configurations,
            predict_positions(campaign, found, points.positions, configurations));
    Geometry geometry{geometric.robot,
                      nearest.robot,
                      nearest.world_from_base,
                      target_positions(geometric, nearest),
                      {},
                      {}};
    geometry.tool = turned_tool(tool_of(campaign, found), geometry.targets);
    const std::vector<Vector3d> targets = target_positions(campaign, found);
    geometry.targets.resize(targets.size());
    geometry.lost =
        loss_of(predict_positions(geometric, nearest, geometry.targets, configurations) -
                predict_positions(campaign, found, targets, configurations));
    return geometry;
}

PositionLoss nominal_loss(const Campaign& campaign, const Parameters& found,
                          const GeometryOptions& options) {
    return loss_of(-fit_nominal(campaign, found, options).displacements);
}

namespace detail {

NominalFit fit_nominal(const Campaign& campaign, const Parameters& found,
                       const GeometryOptions& options) {
    const RowMatrixXd configurations = draw_configurations(campaign, found, options);
    const FlangePoints points{target_positions(campaign, found), known_axes(campaign)};
    const Campaign nominal = geometric_campaign(
        campaign, without_parameters(without_terms(campaign.robot)), found, points);
    const VectorXd wanted = predict_positions(campaign, found, points.positions, configurations);
    const Parameters nearest = fit(nominal, configurations, wanted);
    return {configurations,
            wanted - predict_positions(nominal, nearest, target_positions(nominal, nearest),
                                       configurations)};
}

}  // namespace detail

}  // namespace posewise
