#include "campaign_sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "io/format/text.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

constexpr double least_amount = 1e-12;  // m or rad

}  // namespace

double largest_error(Quantity quantity) {
    constexpr double largest_length = 10;  // m
    return quantity == Quantity::Angle ? std::numbers::pi : largest_length;
}

bool is_plausible_amount(double si, double largest) { return si >= least_amount && si <= largest; }

std::string plausible_amount(const Unit& unit, double largest) {
    return fmt::format("from {:g} to {:g} {}", unit.from_si(least_amount), unit.from_si(largest),
                       unit.name);
}

bool is_true(const YamlMap& map, std::string_view key) {
    const auto value = map.find(key);
    return value && value->boolean();
}

Isometry3d read_frame(const YamlMap& map) {
    Isometry3d frame = Isometry3d::Identity();
    frame.linear() = rotation_from_rpy(map.require_measure("rpy").vector_to_si());
    frame.translation() = map.require_measure("position").vector_to_si();
    return frame;
}

std::vector<bool> read_known(const YamlValue& known, const std::vector<std::string>& names) {
    if (!known.is_list()) {
        const std::string list = fmt::format(", or a list of {}", fmt::join(names, ", "));
        return std::vector<bool>(names.size(), known.boolean(list));
    }
    std::vector<bool> marks(names.size(), false);
    for (const YamlValue& item : known.list()) {
        const std::string name = item.text();
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw item.error("is " + quote(name) + "; " + suggest(name, names));
        const auto k = static_cast<std::size_t>(found - names.begin());
        if (marks[k]) throw item.error("is " + quote(name) + " again; keep one");
        marks[k] = true;
    }
    return marks;
}

double read_positive(const YamlMeasure& measure, bool zero_allowed, double largest) {
    const double value = measure.unit->to_si(measure.value.number());
    const std::string stated = "is " + quote(measure.value.text());
    if (value < 0 || (value == 0 && !zero_allowed)) {
        throw measure.value.error(stated + "; must be " +
                                  (zero_allowed ? "zero or positive" : "positive"));
    }
    if (value != 0 && !is_plausible_amount(value, largest)) {
        throw measure.value.error(stated + "; must be " + plausible_amount(*measure.unit, largest));
    }
    return value;
}

double read_amount(const YamlValue& value, Quantity quantity, Sign sign, double largest) {
    const std::string text = value.text();
    const auto blank = std::min(text.find_first_of(" \t"), text.size());
    const ParsedNumber number = parse_number(std::string_view(text).substr(0, blank));
    const Unit* const unit = find_unit(trim(std::string_view(text).substr(blank)));
    const bool is_sign_right = sign == Sign::Any || number.value > 0;
    if (!number.ok() || unit == nullptr || unit->quantity != quantity || !is_sign_right) {
        throw value.error("is " + quote(text) + "; must be a " +
                          (sign == Sign::Positive ? "positive " : "") + "number and a unit, " +
                          list_words(unit_names(quantity)));
    }
    const double si = unit->to_si(number.value);
    if (sign == Sign::Positive && !is_plausible_amount(si, largest)) {
        throw value.error("is " + quote(text) + "; must be " + plausible_amount(*unit, largest));
    }
    if (!is_plausible(si, quantity)) {
        throw value.error("is " + quote(text) + "; must be " + plausible(*unit));
    }
    return si;
}

}  // namespace posewise::detail
