#include "error_classes.hpp"

#include <cmath>
#include <map>

#include "core/format.hpp"
#include "model/error_class.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

const char* class_name(ErrorClass error_class) {
    switch (error_class) {
        case ErrorClass::Length:
            return "lengths";
        case ErrorClass::Slide:
            return "offsets of joints that slide";
        case ErrorClass::Angle:
            return "angles of axes";
        case ErrorClass::Offset:
            return "joint offsets";
        case ErrorClass::Gravity:
            return "gravity, compliance";
        case ErrorClass::Torque:
            return "torque shapes";
        case ErrorClass::Harmonic:
            return "harmonics";
        case ErrorClass::SlideHarmonic:
            return "harmonics of joints that slide";
        case ErrorClass::Tilt:
            return "tilts of axes";
        case ErrorClass::Gain:
            return "scales, gear ratios";
        case ErrorClass::Other:
            break;
    }
    return "other terms";
}

const char* unit_of(ErrorClass error_class) {
    switch (error_class) {
        case ErrorClass::Length:
        case ErrorClass::Slide:
        case ErrorClass::SlideHarmonic:
            return "mm";
        case ErrorClass::Gain:
            return "per mille";
        default:
            return "mrad";
    }
}

/// The robot's errors, those of a class together.
std::map<ErrorClass, std::vector<Index>> members_by_class(const Chain& robot) {
    std::map<ErrorClass, std::vector<Index>> members;
    for (Index k = 0; k < robot.parameter_count(); ++k)
        members[error_class_of(robot, k)].push_back(k);
    return members;
}

/// In mm, mrad or per mille.
double root_mean_square(const VectorXd& values) {
    return mm_per_m * std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace

Table expected_class_table(const Campaign& campaign) {
    const VectorXd sizes = robot_error_sizes(campaign.spread, campaign.robot);
    Table table{{"class", "count", "expected", ""}, {}};
    for (const auto& [of_class, members] : members_by_class(campaign.robot)) {
        table.rows.push_back({class_name(of_class), std::to_string(members.size()),
                              format_short(root_mean_square(sizes(members)), 3),
                              unit_of(of_class)});
    }
    return table;
}

Table class_table(const Calibration& calibration) {
    const Campaign& campaign = calibration.campaign;
    const auto names = campaign.robot.parameter_names();
    Table table = expected_class_table(campaign);
    table.header = {"class", "count", "expected", "RMS", "largest", "", "which"};
    auto row = table.rows.begin();
    for (const auto& [of_class, members] : members_by_class(campaign.robot)) {
        const VectorXd values = calibration.estimate.parameters.robot(members);
        Index largest = 0;
        values.cwiseAbs().maxCoeff(&largest);
        row->insert(row->end() - 1, {format_fixed(root_mean_square(values), 4),
                                     format_fixed(mm_per_m * values[largest], 4)});
        const Index which = members[static_cast<std::size_t>(largest)];
        row->push_back(names[static_cast<std::size_t>(which)]);
        ++row;
    }
    if (!calibration.stated_spread) return table;
    Campaign stated = campaign;
    stated.spread = *calibration.stated_spread;
    const Table expected = expected_class_table(stated);
    constexpr std::ptrdiff_t at = 2;
    table.header.insert(table.header.begin() + at + 1, "learned");
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        table.rows[k].insert(table.rows[k].begin() + at, expected.rows[k][at]);
    }
    return table;
}

}  // namespace posewise::detail
