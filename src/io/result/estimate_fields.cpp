#include "estimate_fields.hpp"

#include "core/ending_names.hpp"

namespace posewise::detail {
namespace {

/// Lists of values by name.
struct Options {
    using Values = decltype(io::Provenance::options);

    Json write(const Values& options) const {
        Json json;
        for (const auto& [name, values] : options) json[name] = values;
        return json;
    }
    void read(const JsonValue& json, Values& options) const {
        for (const std::string& name : json.keys()) {
            options.emplace_back(name, json[name].texts());
        }
    }
};

}  // namespace

void Size::read(const JsonValue& json, double& value) const {
    Number{.least = least}.read(json, value);
    if (is_plausible(value, is_angle ? Quantity::Angle : Quantity::Length)) return;
    const Unit& unit = *find_unit(is_angle ? "rad" : "m");
    throw json.error(fmt::format("is {:g}; must be {}", value, plausible(unit)));
}

void provenance_fields(const Fields& file, io::Provenance& made_from) {
    file.optional("measurements", true, made_from.measurements);
    if (!file.has("made_from", true)) return;
    const Fields stated = file["made_from"];
    const auto text = [&](const char* key, std::string& value) {
        stated.optional(key, !value.empty(), value);
    };
    text("campaign_file", made_from.campaign_file);
    text("campaign_checksum", made_from.campaign_checksum);
    text("measurements_checksum", made_from.measurements_checksum);
    stated.optional("options", !made_from.options.empty(), made_from.options, Options{});
}

void fit_fields(const Fields& file, Estimate& estimate, std::vector<std::string>& faults) {
    file("ending", estimate.ending, OneOf(ending_names));
    file.optional("faults", !faults.empty(), faults);
    file("iterations", estimate.iterations, Count{});
    file("degrees_of_freedom", estimate.degrees_of_freedom, Count{});
    file("variance_factor", estimate.variance_factor, Number{.least = 0});
    // Only where lengths and angles are measured; files written before have none.
    if (file.has("variance_by_kind", !estimate.variance_by_kind.empty())) {
        const Fields kinds = file["variance_by_kind"];
        estimate.variance_by_kind.resize(2);
        for (const bool is_angle : {false, true}) {
            const Fields kind = kinds[is_angle ? "angles" : "lengths"];
            ResidualVariance& variance = estimate.variance_by_kind[is_angle ? 1 : 0];
            kind("factor", variance.factor, Number{.least = 0});
            kind("degrees_of_freedom", variance.degrees_of_freedom, Number{.least = 0});
        }
    }
    file("model_error_m", estimate.model_error, Size{.is_angle = false, .least = 0});
    file("model_error_rad", estimate.model_error_orientation, Size{.is_angle = true, .least = 0});
    file.optional("model_error_within", true, estimate.model_error_within,
                  Number{.least = 1, .most = model_error_factor});
}

}  // namespace posewise::detail
