#include <algorithm>

#include "core/names.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

constexpr detail::Names<RobotClass, 5> class_names{{{RobotClass::Unknown, "unknown"},
                                                    {RobotClass::Small, "small"},
                                                    {RobotClass::Industrial, "industrial"},
                                                    {RobotClass::Collaborative, "collaborative"},
                                                    {RobotClass::Service, "service"}}};

/// In mm, mrad, and for lengths mm a metre of extent(). `within` are factors, one standard
/// deviation each, of model errors and of sizes.
struct Figures {
    double model_error, model_error_orientation;
    double length, angle, offset, gravity, harmonic;
    KnownWithin within;
};

/// Rounded from what calibrations of all poses found on IRB 120 and Meca500 (small), FANUC R-2000iC
/// and Motoman MA1400 (industrial), iiwa 7, UR10 and Panda (collaborative), Gen3 lite (service).
Figures figures_of(RobotClass kind) {
    switch (kind) {
        case RobotClass::Small:
            return {0.04, 0.12, 0.6, 0.8, 6, 0.6, 0.2, {1.6, 1.7}};
        case RobotClass::Industrial:
            return {0.15, 0.4, 0.6, 0.7, 6, 1.2, 0.3, {1.7, 1.7}};
        case RobotClass::Collaborative:
            return {0.2, 0.6, 0.4, 0.8, 6, 1.5, 0.3, {1.6, 1.7}};
        case RobotClass::Service:
            return {0.8, 2.5, 1.5, 3, 25, 6, 1.5, {1.8, 1.7}};
        case RobotClass::Unknown:
            break;
    }
    return {0.1, 0.1, 0.4, 0.7, 20, 0.7, 0.15, {}};
}

}  // namespace

std::string_view robot_class_name(RobotClass kind) { return detail::name_of(class_names, kind); }

RobotClass parse_robot_class(const std::string& name) {
    if (const auto kind = detail::find_named(class_names, name)) return *kind;
    throw InputError("is " + detail::quote(name) + "; " +
                     detail::suggest(name, detail::words_of(class_names)));
}

Population population_of(RobotClass kind, const Chain& robot) {
    constexpr double least_length = 1e-5;  // m: of axes that cross, without a length between them
    const Figures figures = figures_of(kind);
    Population population;
    population.spread.length = std::max(figures.length / mm_per_m * extent(robot), least_length);
    population.spread.angle = figures.angle / mrad_per_rad;
    population.spread.offset = figures.offset / mrad_per_rad;
    population.spread.gravity = figures.gravity / mrad_per_rad;
    population.spread.harmonic = figures.harmonic / mrad_per_rad;
    population.spread.is_prior = true;
    population.model_error = figures.model_error / mm_per_m;
    population.model_error_orientation = figures.model_error_orientation / mrad_per_rad;
    population.within = figures.within;
    return population;
}

ParameterSpread population_spread(const Chain& robot) {
    return population_of(RobotClass::Unknown, robot).spread;
}

}  // namespace posewise
