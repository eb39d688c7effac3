#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "json.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/criteria/criterion.hpp"

namespace posewise::detail {

/// A value of a JSON document that knows its place, `poses[2].id`, counted from 0 as JSON does.
/// Every reader throws InputError for a value of another kind. Refers to the document.
class JsonValue {
  public:
    JsonValue(const Json& value, std::string path, std::string place = "");

    /// `path: place: problem`.
    InputError error(const std::string& problem) const;
    /// `path: place: is <value>; rule`, of lists and objects the rule alone.
    InputError breaks(const std::string& rule) const;

    const std::string& place() const { return place_; }
    bool has(const std::string& key) const;
    /// The value of a key, which must be there.
    JsonValue operator[](const std::string& key) const;
    std::vector<JsonValue> list() const;
    /// Items of a list of texts.
    std::vector<std::string> texts() const;
    /// Keys and values of an object in the order of the file.
    std::vector<std::string> keys() const;
    std::vector<JsonValue> values() const;

    const Json& json() const { return *value_; }
    bool is_null() const { return value_->is_null(); }
    std::string text() const;
    bool boolean() const;
    double number() const;
    /// Null is `unknown`, which JSON cannot write.
    double number_or(double unknown) const;
    /// A whole number of at least and at most so much.
    Index count(Index least, Index most = std::numeric_limits<Index>::max()) const;
    std::uint64_t natural_number() const;

  private:
    InputError wrong_type(const std::string& wanted) const;

    const Json* value_;
    std::string path_;
    std::string place_;
};

/// A criterion by its name.
Criterion read_criterion(const JsonValue& json);

}  // namespace posewise::detail
