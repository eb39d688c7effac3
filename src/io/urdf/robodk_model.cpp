#include "robodk_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/robot_files.hpp"

namespace posewise::detail {
namespace {

constexpr std::string_view about = R"(#
# A calibrated robot for RoboDK, written by posewise from what RoboDK's public API says of
# setRobotParams(). It was not tried in RoboDK: compare a pose or two first. Run this file while
# RoboDK is open with the station that has the robot. Its joints must count as RoboDK's do there
# (senses, zeros, couplings of RoboDK's own model stay as they are).
#
# Each row is [alpha, a, theta, d] of RotX(alpha) TransX(a) RotZ(theta + joint) TransZ(d) (modified
# Denavit-Hartenberg convention, Craig 1986), in rad and mm. Do not round it: where two axes are
# nearly parallel, d is large.
)";

constexpr std::string_view program = R"(

def send(rdk, robot, matrix):
    """Sets the rows as the robot's accurate kinematics."""
    frames = [matrix(BASE), matrix(TOOL)]
    rdk._check_connection()
    rdk._send_line("S_AbsAccParam")
    rdk._send_item(robot)
    rdk._send_pose(matrix([[float(i == j) for j in range(4)] for i in range(4)]))
    for _ in range(2):
        for frame in frames:
            rdk._send_pose(frame)
        rdk._send_int(len(DHM))
        for row in DHM:
            rdk._send_array(row)
    rdk._send_array([])
    rdk._send_array([])
    rdk._check_status()


if __name__ == "__main__":
    from robodk.robolink import ITEM_TYPE_ROBOT, Robolink
    from robodk.robomath import Mat

    rdk = Robolink()
    send(rdk, rdk.ItemUserPick("Which robot was calibrated?", ITEM_TYPE_ROBOT), Mat)
)";

double plain(double number) { return number + 0.0; }  // never "-0"

std::string frame_text(const std::string& name, const Isometry3d& frame) {
    std::string text = name + " = [\n";
    for (Index row = 0; row < 4; ++row) {
        text += "    [";
        for (Index column = 0; column < 4; ++column) {
            const bool is_length = column == 3 && row < 3;
            fmt::format_to(std::back_inserter(text), "{}{}", column == 0 ? "" : ", ",
                           plain((is_length ? mm_per_m : 1) * frame.matrix()(row, column)));
        }
        text += "],\n";
    }
    return text + "]\n";
}

/// The numbers between "NAME = [" and the bracket that closes it, row by row.
std::vector<std::vector<double>> read_rows(const std::string& path, const std::string& text,
                                           const std::string& name) {
    const std::string begin = '\n' + name + " = [\n";
    std::size_t at = text.find(begin);
    if (at == std::string::npos) throw input_error_at({path}, "has no " + name);
    std::vector<std::vector<double>> rows;
    for (at += begin.size(); at < text.size() && text[at] == ' ';) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        std::string_view line = trim(std::string_view(text).substr(at, end - at));
        at = end + 1;
        if (!line.starts_with('[') || !line.ends_with("],")) {
            throw input_error_at({path}, "has a row of " + name + " that is not in brackets");
        }
        line = line.substr(1, line.size() - 3);
        std::vector<double>& numbers = rows.emplace_back();
        while (!line.empty()) {
            const std::size_t comma = std::min(line.find(','), line.size());
            const ParsedNumber number = parse_number(trim(line.substr(0, comma)));
            if (!number.ok() || rows.back().size() == 4) {
                throw input_error_at({path}, "has a row of " + name + " that is not 4 numbers");
            }
            numbers.push_back(number.value);
            line.remove_prefix(std::min(comma + 1, line.size()));
        }
        if (numbers.size() != 4) {
            throw input_error_at({path}, "has a row of " + name + " that is not 4 numbers");
        }
    }
    return rows;
}

std::vector<Element> read_frame(const std::string& path, const std::string& text,
                                const std::string& name) {
    const auto rows = read_rows(path, text, name);
    if (rows.size() != 4) throw input_error_at({path}, name + " must have 4 rows");
    Isometry3d frame = Isometry3d::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            frame.matrix()(static_cast<Index>(i), static_cast<Index>(j)) =
                rows[i][j] / (j == 3 ? mm_per_m : 1);
        }
    }
    return origin_elements(frame.translation(), rpy_from_rotation(frame.linear()));
}

}  // namespace

std::string robodk_text(const std::string& title, const ModifiedDh& table) {
    std::string text = fmt::format("# {}\n{}\nDHM = [\n", title, about);
    for (const DhRow& row : table.rows) {
        fmt::format_to(std::back_inserter(text), "    [{}, {}, {}, {}],\n", plain(row.alpha),
                       plain(mm_per_m * row.a), plain(row.theta), plain(mm_per_m * row.d));
    }
    text += "]\n# The robot's base frame to that of the first row; the last row's to the flange.\n";
    text += frame_text("BASE", table.base) + frame_text("TOOL", table.tool);
    return text + std::string(program);
}

Chain read_robodk(const std::string& path, const std::vector<Joint>& joints) {
    const std::string text = read_file(path);
    std::vector<Element> elements = read_frame(path, text, "BASE");
    const auto append = [&](const std::vector<Element>& more) {
        elements.insert(elements.end(), more.begin(), more.end());
    };
    const auto rows = read_rows(path, text, "DHM");
    if (rows.size() != joints.size()) {
        throw input_error_at({path}, fmt::format("has {} rows; must have {}, one a joint",
                                                 rows.size(), joints.size()));
    }
    for (std::size_t k = 0; k < rows.size(); ++k) {
        DhRow row;
        row.alpha = rows[k][0];
        row.a = rows[k][1] / mm_per_m;
        row.theta = rows[k][2];
        row.d = rows[k][3] / mm_per_m;
        row.joints = {{static_cast<Index>(k), 1}};
        append(mdh_elements(row));
    }
    append(read_frame(path, text, "TOOL"));
    return {joints, elements};
}

}  // namespace posewise::detail
