#include "posewise/measurement/population.hpp"

#include <algorithm>

#include "core/names.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

constexpr detail::Names<RobotClass, 5> class_names{{{RobotClass::Unknown, "unknown"},
                                                    {RobotClass::Small, "small"},
                                                    {RobotClass::Industrial, "industrial"},
                                                    {RobotClass::Collaborative, "collaborative"},
                                                    {RobotClass::Service, "service"}}};

/// Sizes in mm, mrad, and for lengths mm a metre of extent(); one standard deviation is a factor.
struct Figures {
    double model_error, model_error_within;
    double length, angle, offset, gravity, harmonic, sizes_within;
};

constexpr Figures figures_of(RobotClass kind) {
    switch (kind) {
        case RobotClass::Small: return {0.05, 1.6, 0.3, 0.5, 10, 0.5, 0.12, 1.5};
        case RobotClass::Industrial: return {0.12, 1.6, 0.3, 0.6, 10, 0.8, 0.12, 1.5};
        case RobotClass::Collaborative: return {0.2, 1.6, 0.4, 0.8, 10, 1, 0.3, 1.5};
        case RobotClass::Service: return {0.8, 1.6, 1.2, 3, 30, 5, 0.6, 1.5};
        case RobotClass::Unknown: break;
    }
    return {0.1, model_error_factor, 0.4, 0.7, 20, 0.7, 0.15, error_size_factor};
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
    population.model_error_orientation = figures.model_error / mrad_per_rad;
    population.within = {figures.model_error_within, figures.sizes_within};
    return population;
}

ParameterSpread population_spread(const Chain& robot) {
    return population_of(RobotClass::Unknown, robot).spread;
}

}  // namespace posewise
