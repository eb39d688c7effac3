#pragma once

#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "posewise/core/random.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"

/// Robots in code, so that tests of the lower modules need no files.
namespace posewise::testing {

inline constexpr double degree = std::numbers::pi / 180;

/// A rotation or translation by `coefficient * q[joint]`.
inline Element driven(Motion motion, Axis axis, Index joint, std::string parameter = "",
                      double coefficient = 1) {
    return {motion, axis, 0.0, {{joint, coefficient}}, std::move(parameter)};
}

inline Element rotation(Axis axis, double angle, std::string parameter = "") {
    return {Motion::Rotation, axis, angle, {}, std::move(parameter)};
}

inline Element translation(Axis axis, double length, std::string parameter = "") {
    return {Motion::Translation, axis, length, {}, std::move(parameter)};
}

/// FANUC R-2000iC/165F with its 18 irreducible error parameters; limits of the catalogue in
/// round numbers.
inline Chain fanuc() {
    const auto R = Motion::Rotation;
    return Chain({{"q1", -185 * degree, 185 * degree},
                  {"q2", -60 * degree, 76 * degree},
                  {"q3", -80 * degree, 100 * degree},
                  {"q4", -360 * degree, 360 * degree},
                  {"q5", -125 * degree, 125 * degree},
                  {"q6", -360 * degree, 360 * degree}},
                 {driven(R, Axis::Z, 0),
                  translation(Axis::X, 0.312, "Tx1"),
                  translation(Axis::Y, 0, "Ty1"),
                  rotation(Axis::X, 0, "Rx1"),  //
                  driven(R, Axis::Y, 1, "dq2"),
                  translation(Axis::Z, 1.075, "Tz2"),
                  rotation(Axis::X, 0, "Rx2"),
                  rotation(Axis::Z, 0, "Rz2"),  //
                  driven(R, Axis::Y, 2, "dq3", -1),
                  translation(Axis::Z, 0.225, "Tz3"),
                  translation(Axis::X, 1.280, "Tx3"),
                  rotation(Axis::Z, 0, "Rz3"),  //
                  driven(R, Axis::X, 3, "dq4", -1),
                  translation(Axis::Y, 0, "Ty4"),
                  translation(Axis::Z, 0, "Tz4"),
                  rotation(Axis::Z, 0, "Rz4"),  //
                  driven(R, Axis::Y, 4, "dq5", -1),
                  translation(Axis::Z, 0, "Tz5"),
                  rotation(Axis::Z, 0, "Rz5"),  //
                  driven(R, Axis::X, 5, "", -1)});
}

/// What the links of fanuc() weigh, with a tool of 120 kg.
inline std::vector<Load> fanuc_loads() {
    return {{2, 160, {0, 0.1, 0.5}},
            {3, 190, {0.2, 0, 0.25}},
            {4, 60, {0.6, 0, 0}},
            {5, 40, {0.05, 0, 0}},
            {7, 120, {0.15, 0.05, -0.1}}};
}

/// Planar arm about z with a length and an offset error each link: dq1, dl1, dq2, dl2, ...
inline Chain planar_arm(const std::vector<double>& lengths) {
    std::vector<Joint> joints;
    std::vector<Element> elements;
    for (std::size_t k = 0; k < lengths.size(); ++k) {
        const std::string number = std::to_string(k + 1);
        joints.push_back({"q" + number, -std::numbers::pi, std::numbers::pi});
        elements.push_back(driven(Motion::Rotation, Axis::Z, static_cast<Index>(k), "dq" + number));
        elements.push_back(translation(Axis::X, lengths[k], "dl" + number));
    }
    return Chain(std::move(joints), std::move(elements));
}

/// Gantry (x, y, z) with a spherical wrist (z, y, x), no error parameters.
inline Chain gantry_with_wrist() {
    const auto T = Motion::Translation;
    const auto R = Motion::Rotation;
    return Chain(
        {{"x", 0, 2}, {"y", 0, 1.5}, {"z", -1, 0}, {"a", -3, 3}, {"b", -2, 2}, {"c", -3, 3}},
        {driven(T, Axis::X, 0), driven(T, Axis::Y, 1), driven(T, Axis::Z, 2), driven(R, Axis::Z, 3),
         translation(Axis::Z, -0.2), driven(R, Axis::Y, 4), translation(Axis::X, 0.1),
         driven(R, Axis::X, 5)});
}

/// An upright column that carries an arm of two joints; no error parameters.
inline Chain arm_on_lift() {
    const auto R = Motion::Rotation;
    return Chain(
        {{"lift", 0.2, 1.0}, {"q1", -2, 2}, {"q2", -1, 1}},
        {translation(Axis::Z, 0.3), driven(Motion::Translation, Axis::Z, 0), driven(R, Axis::Z, 1),
         translation(Axis::X, 0.5), driven(R, Axis::Y, 2), translation(Axis::X, 0.4)});
}

/// The robot with the pitch (m) of a joint that slides.
inline Chain with_pitch(const Chain& chain, Index joint, double pitch) {
    std::vector<Joint> joints = chain.joints();
    joints[static_cast<std::size_t>(joint)].pitch = pitch;
    return Chain(std::move(joints), chain.elements(), chain.torques());
}

/// SCARA: two parallel arms, a vertical slide, a turning flange; no error parameters.
inline Chain scara() {
    const auto R = Motion::Rotation;
    return Chain({{"q1", -2, 2}, {"q2", -2.4, 2.4}, {"q3", -0.3, 0}, {"q4", -3, 3}},
                 {driven(R, Axis::Z, 0), translation(Axis::X, 0.4), driven(R, Axis::Z, 1),
                  translation(Axis::X, 0.3), driven(Motion::Translation, Axis::Z, 2),
                  driven(R, Axis::Z, 3)});
}

/// Three parallel axes as a UR10 has them; no error parameters.
inline Chain ur_type() {
    const auto R = Motion::Rotation;
    const double quarter = 90 * degree;
    std::vector<Joint> joints;
    for (const char* name : {"q1", "q2", "q3", "q4", "q5", "q6"}) joints.push_back({name, -3, 3});
    return Chain(
        joints,
        {driven(R, Axis::Z, 0), translation(Axis::Z, 0.1273), rotation(Axis::X, quarter),
         driven(R, Axis::Z, 1), translation(Axis::X, -0.612), driven(R, Axis::Z, 2),
         translation(Axis::X, -0.5723), driven(R, Axis::Z, 3), translation(Axis::Z, 0.163941),
         rotation(Axis::X, quarter), driven(R, Axis::Z, 4), translation(Axis::Z, 0.1157),
         rotation(Axis::X, -quarter), driven(R, Axis::Z, 5), translation(Axis::Z, 0.0922)});
}

/// Seven joints in turn about z and y: redundant.
inline Chain seven_joint_arm() {
    const auto R = Motion::Rotation;
    std::vector<Joint> joints;
    std::vector<Element> elements;
    for (Index j = 0; j < 7; ++j) {
        joints.push_back({"q" + std::to_string(j + 1), -2, 2});
        elements.push_back(driven(R, j % 2 == 0 ? Axis::Z : Axis::Y, j));
        if (j % 2 == 0) elements.push_back(translation(Axis::Z, 0.4));
    }
    return Chain(joints, elements);
}

/// The FANUC on a rail.
inline Chain rail_with_fanuc() {
    const Chain arm = fanuc();
    std::vector<Joint> joints{{"rail", 0, 4}};
    std::vector<Element> elements{driven(Motion::Translation, Axis::Y, 0)};
    for (const Joint& joint : arm.joints()) joints.push_back(joint);
    for (Element element : arm.elements()) {
        for (JointTerm& term : element.joints) ++term.joint;
        elements.push_back(element);
    }
    return Chain(joints, elements);
}

/// A serial robot of four to seven joints about or along random axes, each link of up to half a
/// metre; no error parameters. The last three joints turn, about different axes, so that the tool
/// comes into every orientation.
inline Chain random_robot(RandomStream& stream) {
    const Index count = 4 + stream.index(4);
    std::vector<Joint> joints;
    std::vector<Element> elements;
    Index axis = stream.index(3);
    for (Index j = 0; j < count; ++j) {
        const bool turns = j + 3 >= count || stream.uniform() < 0.8;
        // Another axis than before, so that no two joints do the same.
        axis = (axis + 1 + stream.index(2)) % 3;
        joints.push_back({"q" + std::to_string(j + 1), turns ? -2.0 : -0.5, turns ? 2.0 : 0.5});
        elements.push_back(driven(turns ? Motion::Rotation : Motion::Translation,
                                  static_cast<Axis>(axis), j, "",
                                  stream.uniform() < 0.5 ? -1.0 : 1.0));
        for (const Axis along : {Axis::X, Axis::Y, Axis::Z}) {
            elements.push_back(translation(along, stream.uniform(-0.5, 0.5)));
        }
        elements.push_back(rotation(Axis::X, stream.uniform(-0.3, 0.3)));
    }
    return Chain(std::move(joints), std::move(elements));
}

/// Sine, cosine, coupling and transmission ratio as errors, beside a constant one and alone.
inline Chain with_every_term() {
    using Shape = JointFunction::Shape;
    Element shoulder = driven(Motion::Rotation, Axis::Y, 0, "a", -0.8);
    shoulder.terms = {{"sine", {Shape::Sine, {{0, 1}, {1, -2}}, 0}},
                      {"cosine", {Shape::Sine, {{1, 1.5}}, std::numbers::pi / 2}}};
    Element slide = driven(Motion::Translation, Axis::X, 2);
    slide.terms = {{"coupling", {Shape::Linear, {{0, 0.7}, {2, 1}}, 0.2}}};
    Element link = translation(Axis::Z, 0.5);
    link.terms = {{"sag", {Shape::Sine, {{0, 2}}, 0.3}}, {"ratio", {Shape::Linear, {{1, 1}}, 0}}};
    return Chain({{"q1", -3, 3}, {"q2", -3, 3}, {"s", -1, 1}},
                 {rotation(Axis::X, 0.3, "b"), shoulder, link, driven(Motion::Rotation, Axis::Z, 1),
                  slide, translation(Axis::Y, 0.2, "c")});
}

}  // namespace posewise::testing
