#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "io/format/text.hpp"
#include "measurement/cell_check.hpp"
#include "model/sampling.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/model/chain.hpp"
#include "urdf_tree.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using pugi::xml_node;

double volume(double half_length, double radius) {
    return radius * radius * (2 * half_length + 4.0 / 3 * radius);
}

/// The smallest of some capsules along z that hold a solid from -half_length to half_length with
/// that radius about z (m).
Capsule enclose(double half_length, double radius) {
    constexpr int steps = 64;
    double best_length = 0;
    double best_radius = std::hypot(radius, half_length);
    for (int k = 0; k <= steps; ++k) {
        const double length = half_length * k / steps;
        const double needed = std::hypot(radius, half_length - length);
        if (volume(length, needed) >= volume(best_length, best_radius)) continue;
        best_length = length;
        best_radius = needed;
    }
    return {Vector3d(0, 0, -best_length), Vector3d(0, 0, best_length), best_radius};
}

/// Capsules along the longest edge, beside each other along the second one where the box is flat.
std::vector<Capsule> enclose_box(const Vector3d& size) {
    std::array<Index, 3> axes{0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](Index a, Index b) { return size[a] > size[b]; });
    const double width = size[axes[1]];
    const double thickness = size[axes[2]];
    const auto strips = static_cast<Index>(std::clamp(std::round(width / thickness), 1.0, 4.0));
    const double part = width / static_cast<double>(strips);
    Matrix3d turned;  // z along the longest edge
    turned.col(2) = Vector3d::Unit(axes[0]);
    turned.col(0) = Vector3d::Unit(axes[1]);
    turned.col(1) = turned.col(2).cross(turned.col(0));
    std::vector<Capsule> capsules;
    for (Index k = 0; k < strips; ++k) {
        Isometry3d place = Isometry3d::Identity();
        place.linear() = turned;
        place.translation() =
            Vector3d::Unit(axes[1]) * (part * (static_cast<double>(k) + 0.5) - width / 2);
        capsules.push_back(place * enclose(size[axes[0]] / 2, std::hypot(part / 2, thickness / 2)));
    }
    return capsules;
}

/// The collision shapes of one link.
class ShapeReader {
  public:
    ShapeReader(const XmlDocument& document, const LinkPlace& place, UrdfBodies& bodies,
                std::set<std::string>& meshes)
        : document_(document),
          place_(place),
          subject_("link " + quote(place.link.attribute("name").value())),
          bodies_(bodies),
          meshes_(meshes) {}

    void read() const {
        for (const xml_node collision : place_.link.children("collision")) {
            const xml_node shape = find_child(document_, collision, "geometry").first_child();
            const std::string kind = shape.name();
            if (kind == "mesh") {
                meshes_.insert(place_.link.attribute("name").value());
            } else if (place_.mimic) {
                skip("a collision shape after the mimic " + quote(place_.mimic->name));
            } else if (const auto capsules = enclose_shape(shape, kind); capsules.empty()) {
                skip("a collision shape <" + escape_controls(kind) + ">, which is not known");
            } else {
                add(capsules, origin_of(collision));
            }
        }
    }

  private:
    void skip(const std::string& what) const {
        const std::string sentence =
            subject_ + " has " + what + "; state capsules for it under cell.links";
        if (std::ranges::count(bodies_.skipped, sentence) == 0) bodies_.skipped.push_back(sentence);
    }

    double size(xml_node shape, const char* attribute) const {
        const auto value = read_number(document_, shape, attribute, subject_);
        if (value && *value > 0) return *value;
        throw document_.error(shape, subject_ + " has a <" + shape.name() + "> without positive " +
                                         attribute + "; it must be stated");
    }

    /// In the shape's own frame; none of a kind that is not known.
    std::vector<Capsule> enclose_shape(xml_node shape, const std::string& kind) const {
        if (kind == "sphere") {
            return {{Vector3d::Zero(), Vector3d::Zero(), size(shape, "radius")}};
        }
        if (kind == "cylinder") {
            return {enclose(size(shape, "length") / 2, size(shape, "radius"))};
        }
        if (kind == "capsule") {
            const Vector3d half(0, 0, size(shape, "length") / 2);
            return {{-half, half, size(shape, "radius")}};
        }
        if (kind != "box") return {};
        const auto edges = read_vector(document_, shape, "size", subject_);
        if (!edges || !(edges->array() > 0).all()) {
            throw document_.error(shape, subject_ +
                                             " has a <box> without three positive sizes; "
                                             "they must be stated");
        }
        return enclose_box(*edges);
    }

    Isometry3d origin_of(xml_node collision) const {
        Isometry3d origin = Isometry3d::Identity();
        const xml_node element = find_child(document_, collision, "origin");
        if (!element) return origin;
        const Vector3d none = Vector3d::Zero();
        origin.translation() = read_vector(document_, element, "xyz", subject_).value_or(none);
        origin.linear() =
            rotation_from_rpy(read_vector(document_, element, "rpy", subject_).value_or(none));
        return origin;
    }

    void add(const std::vector<Capsule>& capsules, const Isometry3d& origin) const {
        for (const Capsule& capsule : capsules) {
            bodies_.links.push_back({place_.link.attribute("name").value(), place_.moving,
                                     place_.in_frame * origin * capsule});
        }
    }

    const XmlDocument& document_;
    const LinkPlace& place_;
    std::string subject_;
    UrdfBodies& bodies_;
    std::set<std::string>& meshes_;  ///< links that have one
};

/// Which pairs overlap wherever the robot stands.
std::vector<std::pair<std::size_t, std::size_t>> find_always_overlapping(
    UrdfRobot robot, const std::vector<Link>& links) {
    constexpr Index count = 200;
    constexpr double half_turn = std::numbers::pi;
    for (UrdfJoint& joint : robot.joints) {
        if (!joint.limits) joint.limits = Interval{-half_turn, half_turn};
    }
    const Chain chain = make_chain(robot);
    auto pairs = colliding_pairs(links, links, chain.joint_count());
    const RowMatrixXd drawn = random_configurations(chain, count, 1);
    for (Index i = 0; i < count && !pairs.empty(); ++i) {
        const auto frames = chain.base_from_links(drawn.row(i).transpose(), VectorXd());
        const auto solid = [&](std::size_t k) {
            return frames[static_cast<std::size_t>(links[k].frame)] * links[k].solid;
        };
        std::erase_if(pairs, [&](const auto& pair) {
            return clearance(solid(pair.first), solid(pair.second)) >= 0;
        });
    }
    return pairs;
}

double volume(const Link& link) {
    return volume((link.solid.to - link.solid.from).norm() / 2, link.solid.radius);
}

void skip_overlapping(const UrdfRobot& robot, UrdfBodies& bodies) {
    std::set<std::size_t> skipped;
    for (const auto& [a, b] : find_always_overlapping(robot, bodies.links)) {
        if (skipped.contains(a) || skipped.contains(b)) continue;
        const bool is_first = volume(bodies.links[a]) < volume(bodies.links[b]);
        skipped.insert(is_first ? a : b);
        bodies.skipped.push_back(
            "the capsule around a shape of link " + quote(bodies.links[is_first ? a : b].name) +
            " overlaps that of link " + quote(bodies.links[is_first ? b : a].name) +
            " wherever the robot stands; state smaller ones under cell.links");
    }
    std::vector<Link> kept;
    for (std::size_t k = 0; k < bodies.links.size(); ++k) {
        if (!skipped.contains(k)) kept.push_back(bodies.links[k]);
    }
    bodies.links = std::move(kept);
}

}  // namespace

UrdfBodies read_urdf_bodies(const UrdfRobot& robot) {
    const XmlDocument document(robot.source.path);
    const UrdfPath path = find_path(document, robot.source);
    UrdfBodies bodies;
    std::set<std::string> meshes;
    for (const LinkPlace& place : place_bodies(document, path)) {
        ShapeReader(document, place, bodies, meshes).read();
    }
    skip_overlapping(robot, bodies);
    if (meshes.empty()) return bodies;
    bodies.skipped.push_back("the collision meshes of " +
                             escape_controls(fmt::format("{}", fmt::join(meshes, ", "))) +
                             " are not looked at; state capsules for them under cell.links");
    return bodies;
}

}  // namespace posewise::io
