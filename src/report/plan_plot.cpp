#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "gnuplot.hpp"
#include "plot.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// What of a place is drawn to the right, and up.
struct Projection {
    Index right = 0;
    Index up = 2;

    Eigen::Vector2d of(const Vector3d& place) const { return {place[right], place[up]}; }
};
constexpr Projection from_side{0, 2};
constexpr Projection from_above{0, 1};

std::string point_line(const Eigen::Vector2d& point) {
    return fmt::format("{:.4f} {:.4f}\n", point.x(), point.y());
}

/// The convex hull, counterclockwise [Andrew 1979].
std::vector<Eigen::Vector2d> hull_of(std::vector<Eigen::Vector2d> points) {
    std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    const auto turns_left = [](const auto& a, const auto& b, const auto& c) {
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x() > 0;
    };
    std::vector<Eigen::Vector2d> hull;
    for (const bool is_upper : {false, true}) {
        const std::size_t begin = hull.size();
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Eigen::Vector2d& next = points[is_upper ? points.size() - 1 - k : k];
            while (hull.size() >= begin + 2 && !turns_left(hull.end()[-2], hull.back(), next)) {
                hull.pop_back();
            }
            hull.push_back(next);
        }
        hull.pop_back();  // where the other side begins
    }
    return hull;
}

std::string polygon(const std::vector<Eigen::Vector2d>& points) {
    std::string lines;
    const std::vector<Eigen::Vector2d> hull = hull_of(points);
    for (const Eigen::Vector2d& point : hull) lines += point_line(point);
    return lines + point_line(hull.front()) + '\n';
}

std::string box_outline(const SceneBox& box, const Isometry3d& base_from_world,
                        const Projection& projection) {
    std::vector<Eigen::Vector2d> corners;
    for (const double x : {-0.5, 0.5}) {
        for (const double y : {-0.5, 0.5}) {
            for (const double z : {-0.5, 0.5}) {
                const Vector3d corner = box.size.cwiseProduct(Vector3d(x, y, z));
                corners.push_back(projection.of(base_from_world * (box.world_from_box * corner)));
            }
        }
    }
    return polygon(corners);
}

std::string capsule_outline(const Capsule& capsule, const Projection& projection) {
    constexpr int sides = 32;
    std::vector<Eigen::Vector2d> points;
    for (const Vector3d& end : {capsule.from, capsule.to}) {
        for (int k = 0; k < sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides;
            points.emplace_back(projection.of(end) +
                                capsule.radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
        }
    }
    return polygon(points);
}

/// Obstacles of the cell.
std::string solids(const Scene& scene, const Projection& projection) {
    const Isometry3d base_from_world = scene.world_from_base.inverse();
    std::string lines;
    for (const SceneBox& box : scene.boxes) {
        if (box.is_obstacle) lines += box_outline(box, base_from_world, projection);
    }
    for (const SceneCapsule& capsule : scene.capsules) {
        if (capsule.is_obstacle) lines += capsule_outline(capsule.solid, projection);
    }
    return lines;
}

/// A wall, or the floor, across an axis of the base frame.
struct DrawnWall {
    Index axis = 0;
    double place = 0;
};

std::vector<DrawnWall> drawn_walls(const Scene& scene) {
    constexpr double along = 0.9998;  // within 1 deg
    const Isometry3d base_from_world = scene.world_from_base.inverse();
    std::vector<SceneWall> walls = scene.walls;
    if (scene.floor_z) {
        Vector3d below = scene.world_from_base.translation();
        below.z() = *scene.floor_z;
        walls.push_back({"floor", below, Vector3d::UnitZ()});
    }
    std::vector<DrawnWall> drawn;
    for (const SceneWall& wall : walls) {
        const Vector3d normal = base_from_world.linear() * wall.normal;
        for (Index axis = 0; axis < 3; ++axis) {
            if (std::abs(normal[axis]) < along) continue;
            drawn.push_back({axis, (base_from_world * wall.point)[axis]});
        }
    }
    return drawn;
}

/// What there is to see, in the base frame: both pictures have its scale.
struct Bounds {
    Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
    Vector3d upper = -lower;

    void include(const Vector3d& place, double radius = 0) {
        lower = lower.cwiseMin(place - Vector3d::Constant(radius));
        upper = upper.cwiseMax(place + Vector3d::Constant(radius));
    }
};

Bounds find_bounds(const Plan& plan, const Scene& scene) {
    const Isometry3d base_from_world = scene.world_from_base.inverse();
    Bounds bounds;
    for (const PlannedPose& pose : plan.poses) {
        for (const Vector3d& place : arm_places(scene, pose.configuration)) bounds.include(place);
    }
    for (const SceneCapsule& capsule : scene.capsules) {
        if (!capsule.is_obstacle) continue;
        bounds.include(capsule.solid.from, capsule.solid.radius);
        bounds.include(capsule.solid.to, capsule.solid.radius);
    }
    for (const SceneBox& box : scene.boxes) {
        if (box.is_obstacle) {
            bounds.include(base_from_world * box.world_from_box.translation(), box.size.norm() / 2);
        }
    }
    if (scene.instrument) bounds.include(base_from_world * scene.instrument->position);
    constexpr double near = 0.3;  // of the size; a wall that is farther away is not seen
    const Vector3d size = bounds.upper - bounds.lower;
    for (const DrawnWall& wall : drawn_walls(scene)) {
        const Index axis = wall.axis;
        if (wall.place < bounds.lower[axis] - near * size[axis] ||
            wall.place > bounds.upper[axis] + near * size[axis]) {
            continue;
        }
        bounds.lower[axis] = std::min(bounds.lower[axis], wall.place);
        bounds.upper[axis] = std::max(bounds.upper[axis], wall.place);
    }
    const double margin = 0.05 * (bounds.upper - bounds.lower).maxCoeff();
    bounds.lower.array() -= margin;
    bounds.upper.array() += margin;
    return bounds;
}

/// Both pictures are as high.
double height_of(const Bounds& bounds) {
    return (bounds.upper - bounds.lower).tail<2>().maxCoeff();
}

/// Those that are seen.
std::string edges(const Scene& scene, const Bounds& bounds, const Projection& projection) {
    std::string commands;
    for (const auto& [axis, place] : drawn_walls(scene)) {
        const bool is_upright = axis == projection.right;
        if (!is_upright && axis != projection.up) continue;
        if (place < bounds.lower[axis] || place > bounds.upper[axis]) continue;
        commands += is_upright ? fmt::format(
                                     "set arrow from first {0:.4f}, graph 0 to first "
                                     "{0:.4f}, graph 1",
                                     place)
                               : fmt::format(
                                     "set arrow from graph 0, first {0:.4f} to graph 1, "
                                     "first {0:.4f}",
                                     place);
        commands += " nohead lw 3 lc rgb '#8a939d'\n";
    }
    return commands;
}

std::string ranges(const Bounds& bounds, const Projection& projection) {
    const Eigen::Vector2d lower = projection.of(bounds.lower);
    const Eigen::Vector2d upper = projection.of(bounds.upper);
    const double middle = (lower.y() + upper.y()) / 2;
    const double half = height_of(bounds) / 2;
    return fmt::format("set xrange [{:.4f}:{:.4f}]\nset yrange [{:.4f}:{:.4f}]\n", lower.x(),
                       upper.x(), middle - half, middle + half);
}

/// Lines of the arm at each pose with its number, and where the targets are then.
struct Arms {
    std::string lines;
    std::string targets;
};

Arms draw_arms(const Plan& plan, const Scene& scene, const Projection& projection) {
    Arms arms;
    int number = 0;
    for (const PlannedPose& pose : plan.poses) {
        ++number;
        std::string end;
        for (const Vector3d& place : arm_places(scene, pose.configuration)) {
            const Eigen::Vector2d point = projection.of(place);
            end = fmt::format("{:.4f} {:.4f} {}", point.x(), point.y(), number);
            arms.lines += end + '\n';
        }
        arms.lines += '\n';
        arms.targets += end + '\n';
    }
    return arms;
}

std::string panel(const Plan& plan, const Scene& scene, const Bounds& bounds,
                  const Projection& projection, const std::string& name) {
    const Arms arms = draw_arms(plan, scene, projection);
    const std::string cell = solids(scene, projection);
    std::string data = fmt::format("$arms_{0} << EOD\n{1}EOD\n$targets_{0} << EOD\n{2}EOD\n", name,
                                   arms.lines, arms.targets);
    std::string clauses, labels;
    if (!cell.empty()) {
        data += fmt::format("$cell_{} << EOD\n{}EOD\n", name, cell);
        clauses += fmt::format(
            "$cell_{0} using 1:2 with filledcurves closed fc rgb '#e3e7eb' notitle, "
            "$cell_{0} using 1:2 with lines lc rgb '#aab2bb' notitle, ",
            name);
    }
    clauses += fmt::format(
        "$arms_{0} using 1:2:3 with lines lw 1.5 lc palette notitle, "
        "$targets_{0} using 1:2:3 with points pt 7 ps 0.6 lc palette notitle",
        name);
    if (scene.instrument) {
        const Eigen::Vector2d place =
            projection.of(scene.world_from_base.inverse() * scene.instrument->position);
        data += fmt::format("$tracker_{} << EOD\n{}EOD\n", name, point_line(place));
        labels = fmt::format("set label {} at {:.4f},{:.4f} center front offset 0,-1.1\n",
                             gnuplot_text(scene.instrument->kind), place.x(), place.y());
        clauses += fmt::format(
            ", $tracker_{} using 1:2 with points pt 9 ps 1.4 lc rgb '#c8401f' notitle", name);
    }
    return fmt::format("{}unset arrow\nunset label\n{}{}plot {}\n", data, labels,
                       edges(scene, bounds, projection), clauses);
}

}  // namespace

std::string plan_plot_script(const Plan& plan, const Scene& scene, const std::string& image_path) {
    check_image_path(image_path);
    if (plan.poses.empty() || plan.poses.front().configuration.size() == 0) {
        throw InputError("the plan has no robot to draw");
    }
    const auto count = plan.poses.size();
    const Bounds bounds = find_bounds(plan, scene);
    // Pixels: of one picture, and what is above and below it.
    constexpr double all = 1200, width = 520, above = 80, below = 170;
    const double height =
        std::clamp(width * height_of(bounds) / (bounds.upper - bounds.lower).x(), 150.0, 1200.0);
    const double whole = above + height + below;
    return gnuplot_output(image_path, all, whole) +
           fmt::format(
               "set multiplot layout 1,2 title {} noenhanced margins {:.4f},{:.4f},{:.4f},{:.4f} "
               "spacing {:.4f},0\n"
               "set size ratio -1\nset border 3 lc rgb '#5f6b77'\nset grid lc rgb '#e6eaee'\n"
               "set xtics out nomirror\nset ytics out nomirror\n"
               "set palette defined (0 '#0b3c6f', 0.5 '#2f9e77', 1 '#f0b429')\n"
               "set cbrange [1:{}]\nset cbtics 1,{}\nset cblabel 'order to visit them'\n"
               "set xlabel 'x (m)'\nunset key\n",
               gnuplot_text(plan.campaign), 80 / all, (80 + 2 * width + 70) / all, below / whole,
               1 - above / whole, 70 / all, std::max<std::size_t>(count, 2),
               std::max<std::size_t>(1, (count + 11) / 12)) +
           "unset colorbox\nset title 'from the side'\nset ylabel 'z (m)'\n" +
           ranges(bounds, from_side) + panel(plan, scene, bounds, from_side, "side") +
           fmt::format("set colorbox horizontal user origin 0.3,{:.4f} size 0.4,{:.4f}\n",
                       72 / whole, 14 / whole) +
           "set title 'from above'\nset ylabel 'y (m)'\n" + ranges(bounds, from_above) +
           panel(plan, scene, bounds, from_above, "above") + "unset multiplot\nset output\n";
}

}  // namespace posewise::detail
