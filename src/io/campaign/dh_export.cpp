#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/format/units.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/robot_files.hpp"

namespace posewise::io {
namespace {

double in_file_unit(Motion motion, double si) {
    return detail::find_unit(units_of(motion).reading)->from_si(si);
}

/// "-q3 + 0.98*q2".
std::string drive_text(const Chain& chain, const std::vector<JointTerm>& terms) {
    std::string text;
    for (const JointTerm& term : terms) {
        const bool is_negative = term.coefficient < 0;
        text += text.empty() ? (is_negative ? "-" : "") : (is_negative ? " - " : " + ");
        const double size = std::abs(term.coefficient);
        if (size != 1) text += fmt::format("{}*", size);
        text += chain.joints()[static_cast<std::size_t>(term.joint)].name;
    }
    return text;
}

/// The joint whose row this is: the first it names that has no row yet.
Index own_joint(const Chain& chain, const DhRow& row, std::vector<bool>& has_row) {
    for (const JointTerm& term : row.joints) {
        const auto joint = static_cast<std::size_t>(term.joint);
        if (has_row[joint]) continue;
        has_row[joint] = true;
        return term.joint;
    }
    throw InputError(
        "joint '" + chain.joints()[static_cast<std::size_t>(row.joints.front().joint)].name +
        "' drives more than one axis, which a Denavit-Hartenberg table cannot express");
}

std::string joint_text(const Chain& chain, const DhRow& row, Index own) {
    const Joint& joint = chain.joints()[static_cast<std::size_t>(own)];
    const bool turns = row.motion == Motion::Rotation;
    std::string text =
        fmt::format(", limits_{}: [{}, {}]", units_of(row.motion).reading,
                    in_file_unit(row.motion, joint.lower), in_file_unit(row.motion, joint.upper));
    if (!turns) text += ", kind: prismatic";
    if (joint.pitch > 0) {
        text += fmt::format(", pitch_mm: {}", in_file_unit(row.motion, joint.pitch));
    }
    const std::string drive = drive_text(chain, row.joints);
    return drive == joint.name ? text : text + ", drive: " + drive;
}

}  // namespace

std::string make_dh_text(const Chain& chain, const std::vector<DhRow>& rows) {
    std::vector<bool> has_row(chain.joints().size(), false);
    std::string text =
        "robot:\n  dh:\n"
        "    # RotZ(theta) TransZ(d) TransX(a) RotX(alpha); where the next axis is nearly "
        "parallel\n"
        "    # RotZ(theta) TransX(a) RotX(alpha) RotY(beta) (Hayati)\n"
        "    convention: standard\n    rows:\n";
    for (const DhRow& row : rows) {
        const auto number = [](Motion motion, double si) { return in_file_unit(motion, si); };
        std::string amounts =
            fmt::format("a_mm: {}, alpha_deg: {}, d_mm: {}, theta_deg: {}",
                        number(Motion::Translation, row.a), number(Motion::Rotation, row.alpha),
                        number(Motion::Translation, row.d), number(Motion::Rotation, row.theta));
        if (row.beta != 0) {
            amounts += fmt::format(", beta_deg: {}", number(Motion::Rotation, row.beta));
        }
        if (row.joints.empty()) {
            fmt::format_to(std::back_inserter(text), "      - {{{}}}\n", amounts);
            continue;
        }
        const Index own = own_joint(chain, row, has_row);
        fmt::format_to(std::back_inserter(text), "      - {{joint: {}, {}{}}}\n",
                       chain.joints()[static_cast<std::size_t>(own)].name, amounts,
                       joint_text(chain, row, own));
    }
    return text;
}

}  // namespace posewise::io
