#pragma once

#include <fmt/format.h>

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/names.hpp"
#include "core/text.hpp"
#include "json_reader.hpp"

/// Records as JSON, written and read by one statement of their fields:
///
///     void drift_fields(const Fields& file, Drift& drift) {
///         file("length_m", drift.length, Number{.above = 0});
///         file("angle_rad", drift.angle, Number{.above = 0});
///     }
///     drift_fields(Fields(json), drift);                   // writes to a Json
///     drift_fields(Fields(JsonValue(json, path)), drift);  // reads
///
/// A field has a key, a member and a form: what the member looks like and may be. A form has
/// `read(json, member)`, which throws InputError for what it may not be, and `write(member)` unless
/// JSON is that already. The form of a list may be that of its items, the form of what is optional
/// that of its value: it is null without one, but not where it is read.
namespace posewise::detail {

/// Any value of its type: the form of a field that states none.
struct AnyValue {
    Json write(Criterion value) const { return criterion_name(value); }
    void read(const JsonValue& json, Criterion& value) const { value = read_criterion(json); }
    void read(const JsonValue& json, bool& value) const { value = json.boolean(); }
    void read(const JsonValue& json, double& value) const { value = json.number(); }
    void read(const JsonValue& json, std::uint64_t& value) const { value = json.natural_number(); }
    void read(const JsonValue& json, std::string& value) const { value = json.text(); }
};

/// A whole number of at least and at most so much.
struct Count {
    Index least = 0;
    Index most = std::numeric_limits<Index>::max();

    void read(const JsonValue& json, Index& value) const { value = json.count(least, most); }
};

/// A number within limits.
struct Number {
    double least = -std::numeric_limits<double>::infinity();
    double above = -std::numeric_limits<double>::infinity();  ///< not at it
    double most = std::numeric_limits<double>::infinity();
    std::optional<double> null{};  ///< what null stands for: JSON has neither infinity nor NaN

    void read(const JsonValue& json, double& value) const {
        value = null ? json.number_or(*null) : json.number();
        if (json.is_null()) return;
        if (!(value >= least)) throw json.breaks(fmt::format("must be at least {:g}", least));
        if (!(value > above)) throw json.breaks(fmt::format("must be above {:g}", above));
        if (!(value <= most)) throw json.breaks(fmt::format("must be at most {:g}", most));
    }
};

/// One of those that have a name, by that. Refers to the names.
template <typename T, std::size_t count>
class OneOf {
  public:
    explicit OneOf(const Names<T, count>& names) : names_(names) {}

    Json write(T value) const { return name_of(names_, value); }
    void read(const JsonValue& json, T& value) const {
        const std::optional<T> found = find_named(names_, json.text());
        if (!found) throw json.breaks("must be " + list_words(words_of(names_)));
        value = *found;
    }

  private:
    const Names<T, count>& names_;
};

template <typename T>
constexpr bool is_list = false;
template <typename T>
constexpr bool is_list<std::vector<T>> = true;

template <typename T, typename Form>
Json written(const T& value, const Form& form) {
    if constexpr (requires { form.write(value); }) {
        return form.write(value);
    } else if constexpr (requires { value.has_value(); }) {
        return value ? written(*value, form) : Json(nullptr);
    } else if constexpr (is_list<T>) {
        Json list = Json::array();
        for (const auto& item : value) list.push_back(written(item, form));
        return list;
    } else {
        return value;
    }
}

template <typename T, typename Form>
void read(const JsonValue& json, T& value, const Form& form) {
    if constexpr (requires { form.read(json, value); }) {
        form.read(json, value);
    } else if constexpr (is_list<T>) {
        value.clear();
        for (const JsonValue& item : json.list()) read(item, value.emplace_back(), form);
    } else {
        read(json, value.emplace(), form);
    }
}

/// The fields of an object of JSON, to write them or to read them.
class Fields {
  public:
    /// To write them: those of an object in another before that gets its next one.
    explicit Fields(Json& object) : written_(&object) {
        if (object.is_null()) object = Json::object();
    }
    explicit Fields(const JsonValue& object) : read_(object) {}

    template <typename T, typename Form = AnyValue>
    void operator()(const char* key, T& value, const Form& form = {}) const {
        if (read_) {
            read((*read_)[key], value, form);
        } else {
            (*written_)[key] = written(value, form);
        }
    }
    /// One that need not be there; it is written if that is said.
    template <typename T, typename Form = AnyValue>
    void optional(const char* key, bool is_written, T& value, const Form& form = {}) const {
        if (has(key, is_written)) (*this)(key, value, form);
    }
    /// Whether there is one, or shall be.
    bool has(const char* key, bool is_written) const {
        return read_ ? read_->has(key) : is_written;
    }
    /// What must hold for the value of a key that is read.
    void check(const char* key, bool holds, const std::string& rule) const {
        if (!read_ || holds) return;
        const JsonValue value = (*read_)[key];
        throw value.breaks(rule);
    }
    /// `poses[2]`, where it is read.
    std::string place() const { return read_ ? read_->place() : ""; }

    /// An object within this one.
    Fields operator[](const char* key) const {
        return read_ ? Fields((*read_)[key]) : Fields((*written_)[key]);
    }
    /// A list of objects, each with the fields that `state(fields, item)` states.
    template <typename T, typename State>
    void list(const char* key, std::vector<T>& items, const State& state) const {
        if (read_) {
            for (const JsonValue& item : (*read_)[key].list()) {
                state(Fields(item), items.emplace_back());
            }
        } else {
            Json& list = (*written_)[key] = Json::array();
            for (T& item : items) state(Fields(list.emplace_back()), item);
        }
    }

  private:
    std::optional<JsonValue> read_;
    Json* written_ = nullptr;
};

}  // namespace posewise::detail
