#include "json_reader.hpp"

#include "core/text.hpp"

namespace posewise::detail {

JsonValue::JsonValue(const Json& value, std::string path, std::string place)
    : value_(&value), path_(std::move(path)), place_(std::move(place)) {}

InputError JsonValue::error(const std::string& problem) const {
    return input_error_at({path_}, place_ + ": " + problem);
}

InputError JsonValue::breaks(const std::string& rule) const {
    if (value_->is_structured()) return error(rule);
    const std::string value = value_->is_string() ? quote(text()) : value_->dump();
    return error("is " + value + "; " + rule);
}

InputError JsonValue::wrong_type(const std::string& wanted) const {
    return error(std::string("is of type ") + value_->type_name() + "; must be " + wanted);
}

bool JsonValue::has(const std::string& key) const {
    return value_->is_object() && value_->contains(key);
}

JsonValue JsonValue::operator[](const std::string& key) const {
    const std::string place = place_.empty() ? key : place_ + '.' + key;
    if (!value_->is_object()) throw wrong_type("an object");
    const auto found = value_->find(key);
    if (found == value_->end()) {
        throw input_error_at({path_}, place + ": is missing; must be there as posewise writes it");
    }
    return {*found, path_, place};
}

std::vector<JsonValue> JsonValue::list() const {
    if (!value_->is_array()) throw wrong_type("a list");
    std::vector<JsonValue> items;
    for (const Json& item : *value_) {
        items.emplace_back(item, path_, place_ + '[' + std::to_string(items.size()) + ']');
    }
    return items;
}

std::vector<std::string> JsonValue::texts() const {
    std::vector<std::string> texts;
    for (const JsonValue& item : list()) texts.push_back(item.text());
    return texts;
}

std::vector<std::string> JsonValue::keys() const {
    if (!value_->is_object()) throw wrong_type("an object");
    std::vector<std::string> keys;
    for (const auto& [key, unused] : value_->items()) keys.push_back(key);
    return keys;
}

std::vector<JsonValue> JsonValue::values() const {
    if (!value_->is_object()) throw wrong_type("an object");
    std::vector<JsonValue> items;
    for (const auto& [key, item] : value_->items()) {
        items.emplace_back(item, path_, place_ + '.' + key);
    }
    return items;
}

std::string JsonValue::text() const {
    if (!value_->is_string()) throw wrong_type("text");
    return value_->get<std::string>();
}

bool JsonValue::boolean() const {
    if (!value_->is_boolean()) throw wrong_type("true or false");
    return value_->get<bool>();
}

double JsonValue::number() const {
    if (!value_->is_number()) throw wrong_type("a number");
    return value_->get<double>();
}

double JsonValue::number_or(double unknown) const { return is_null() ? unknown : number(); }

Index JsonValue::count(Index least, Index most) const {
    if (!value_->is_number_integer()) throw wrong_type("a whole number");
    const auto value = value_->get<std::int64_t>();
    const bool is_huge = value_->is_number_unsigned() &&
                         value_->get<std::uint64_t>() > static_cast<std::uint64_t>(most);
    if (is_huge || value > most) throw breaks("must be at most " + std::to_string(most));
    if (value < least) throw breaks("must be at least " + std::to_string(least));
    return value;
}

std::uint64_t JsonValue::natural_number() const {
    if (!value_->is_number_unsigned()) throw wrong_type("a whole number that is not negative");
    return value_->get<std::uint64_t>();
}

Criterion read_criterion(const JsonValue& json) {
    const std::string name = json.text();
    try {
        return parse_criterion(name);
    } catch (const InputError& problem) {
        throw json.error(problem.what());
    }
}

}  // namespace posewise::detail
