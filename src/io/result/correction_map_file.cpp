#include <fmt/format.h>

#include <iterator>
#include <vector>

#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/robot_files.hpp"

namespace posewise::io {
namespace {

using Shape = MapFactor::Shape;

std::string describe(const MapError& error) {
    return fmt::format("{:.4f} mm RMS, {:.4f} mm at 95 %, {:.4f} mm at most, {:.4f} mrad RMS",
                       mm_per_m * error.rms, mm_per_m * error.p95, mm_per_m * error.largest,
                       mrad_per_rad * error.orientation);
}

/// One line of printable text without what ends a comment.
std::string plain(const std::string& text) {
    std::string line;
    for (const char letter : text) {
        const bool is_plain = letter >= ' ' && letter <= '~' && letter != '*' && letter != '\\';
        line += is_plain ? letter : '_';
    }
    return line;
}

/// What the file is, a line each.
std::vector<std::string> explain(const std::string& title, const CorrectionMap& map,
                                 const std::string& send) {
    std::string joints;
    for (const Joint& joint : map.robot.joints()) {
        joints += fmt::format("{}{} ({})", joints.empty() ? "" : ", ", plain(joint.name),
                              joint.motion == Motion::Rotation ? "rad" : "m");
    }
    return {
        plain(title) + ": what of the calibration depends on the joints' positions",
        "(bending, periodic errors, scales), which a URDF or DH table cannot hold.",
        "Joints: " + joints + ", as the campaign's robot counts them.",
        "Use: find joint values q with the calibrated geometry (posewise export --urdf or --dh",
        "with --geometry estimate). Send " + send + ".",
        fmt::format("At {} random configurations within the joint limits, none of them of a grid,",
                    map.pose_count),
        "the distance of the targets from where the geometry is at q is by the estimate:",
        "  q sent as it is:  " + describe(map.geometry_alone),
        "  with this map:    " + describe(map.with_map),
        "The estimate's own error comes on top.",
    };
}

int code_of(Shape shape) {
    if (shape == Shape::Power) return 1;
    return shape == Shape::Cosine ? 2 : 3;
}

std::string c_term(const MapTerm& term, Index joints) {
    std::vector<int> shapes(static_cast<std::size_t>(joints), 0);
    std::vector<double> orders(static_cast<std::size_t>(joints), 0);
    for (const MapFactor& factor : term.factors) {
        shapes[static_cast<std::size_t>(factor.joint)] = code_of(factor.shape);
        orders[static_cast<std::size_t>(factor.joint)] = factor.order;
    }
    std::string text = "    {{";
    for (const int shape : shapes) text += fmt::format("{},", shape);
    text.back() = '}';
    text += ",{";
    for (const double order : orders) text += fmt::format("{:.12g},", order);
    text.back() = '}';
    text += ",{";
    for (const double amount : term.amounts) text += fmt::format("{:.10g},", amount + 0.0);
    text.back() = '}';
    return text + "},\n";
}

constexpr const char* c_functions = R"(};

/* What the joints seem to be off by at q. */
void posewise_map(const double q[POSEWISE_JOINTS], double sum[POSEWISE_JOINTS]) {
    int j;
    unsigned k;
    for (j = 0; j < POSEWISE_JOINTS; ++j) sum[j] = 0;
    for (k = 0; k < sizeof posewise_terms / sizeof posewise_terms[0]; ++k) {
        double product = 1;
        for (j = 0; j < POSEWISE_JOINTS; ++j) {
            const double order = posewise_terms[k].order[j];
            switch (posewise_terms[k].shape[j]) {
                case 1: product *= pow(q[j], order); break;
                case 2: product *= cos(order * q[j]); break;
                case 3: product *= sin(order * q[j]); break;
                default: break;
            }
        }
        for (j = 0; j < POSEWISE_JOINTS; ++j) sum[j] += product * posewise_terms[k].amount[j];
    }
}

/* The joint values to send, so that the robot is where its geometry is at q. */
void posewise_joints_to_send(const double q[POSEWISE_JOINTS], double sent[POSEWISE_JOINTS]) {
    double sum[POSEWISE_JOINTS];
    int j, step;
    for (j = 0; j < POSEWISE_JOINTS; ++j) sent[j] = q[j];
    for (step = 0; step < 3; ++step) {
        posewise_map(sent, sum);
        for (j = 0; j < POSEWISE_JOINTS; ++j) sent[j] = q[j] - sum[j];
    }
}
)";

std::string c_text(const std::string& title, const CorrectionMap& map) {
    std::string text = "/*\n";
    for (const std::string& line :
         explain(title, map, "what posewise_joints_to_send() makes of q")) {
        text += " * " + line + '\n';
    }
    const Index joints = map.robot.joint_count();
    fmt::format_to(std::back_inserter(text),
                   " */\n#include <math.h>\n\n#define POSEWISE_JOINTS {}\n\n"
                   "/* Each adds its amounts times a product over the joints: 1 (shape 0), q^order "
                   "(1),\n * cos(order q) (2) or sin(order q) (3). */\n"
                   "static const struct {{\n    unsigned char shape[POSEWISE_JOINTS];\n    double "
                   "order[POSEWISE_JOINTS];\n    double amount[POSEWISE_JOINTS];\n}} "
                   "posewise_terms[] = {{\n",
                   joints);
    for (const MapTerm& term : map.terms) text += c_term(term, joints);
    return text + c_functions;
}

std::string factor_text(const MapFactor& factor, const std::string& joint) {
    if (factor.shape == Shape::Power) return fmt::format("{}^{:g}", joint, factor.order);
    return fmt::format("{}({:.12g} {})", factor.shape == Shape::Cosine ? "cos" : "sin",
                       factor.order, joint);
}

std::string csv_text(const std::string& title, const CorrectionMap& map) {
    std::string text;
    for (const std::string& line : explain(
             title, map,
             "s = q - map(s), three times from s = q; map is the sum over the rows of amount times "
             "factors (rad, m)")) {
        text += "# " + line + '\n';
    }
    text += "factors";
    for (const Joint& joint : map.robot.joints()) {
        text += ',' +
                detail::csv_field(joint.name + (joint.motion == Motion::Rotation ? "_rad" : "_m"));
    }
    text += '\n';
    for (const MapTerm& term : map.terms) {
        std::string factors;
        for (const MapFactor& factor : term.factors) {
            factors += (factors.empty() ? "" : " ") +
                       factor_text(factor, map.robot.joint(factor.joint).name);
        }
        text += detail::csv_field(factors.empty() ? "1" : factors);
        for (const double amount : term.amounts) text += fmt::format(",{:.10g}", amount + 0.0);
        text += '\n';
    }
    return text;
}

}  // namespace

void check_map_path(const std::string& path) {
    if (path.ends_with(".c") || path.ends_with(".csv")) return;
    throw input_error_at({path}, "must end in .c (a C source) or .csv (its table)");
}

void write_correction_map(const std::string& path, const std::string& title,
                          const CorrectionMap& map) {
    check_map_path(path);
    detail::write_file(path, path.ends_with(".c") ? c_text(title, map) : csv_text(title, map));
}

}  // namespace posewise::io
