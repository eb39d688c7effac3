#pragma once

#include <yaml-cpp/yaml.h>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "units.hpp"

namespace posewise::detail {

struct YamlEntry;

/// A value of a YAML file that knows its name and where it stands, so that whatever is wrong with
/// it can be said in one line. Every reader throws InputError for a value of another kind.
class YamlValue {
  public:
    YamlValue(YAML::Node node, FileLocation location, std::string name);

    const FileLocation& location() const { return location_; }
    /// "robot.joints.q1"; empty for the whole file.
    const std::string& name() const { return name_; }

    /// `path:line:column: name problem`.
    InputError error(const std::string& problem) const;

    std::string text() const;
    bool is_text(std::string_view text) const { return node_.IsScalar() && node_.Scalar() == text; }
    /// Where the first character of text() stands (behind the quotation mark if there is one).
    FileLocation text_location() const;
    /// `or_else`: what else the caller takes, for the message: ", or a list".
    double number(const std::string& or_else = "") const;
    /// `what`: the largest is, for the message: ", the number of targets".
    std::uint64_t natural_number(std::uint64_t least = 0,
                                 std::uint64_t most = std::numeric_limits<std::uint64_t>::max(),
                                 const std::string& what = "") const;
    bool boolean(const std::string& or_else = "") const;
    bool is_list() const { return node_.IsSequence(); }
    bool is_map() const { return node_.IsMap(); }
    /// Items of a list.
    std::vector<YamlValue> list() const;
    /// A list of exactly `count` numbers.
    std::vector<double> numbers(std::size_t count) const;
    /// Keys and values of a map, in the order of the file. No key occurs twice.
    std::vector<YamlEntry> entries() const;

  private:
    YAML::Node node_;
    FileLocation location_;
    std::string name_;
};

struct YamlEntry {
    std::string key;
    FileLocation key_location;
    YamlValue value;
};

/// A value whose unit is the suffix of its key: `sigma_mm: 0.05`. Throws InputError for what no
/// robot cell has, over 1000 km or 10000 rad.
struct YamlMeasure {
    YamlValue value;
    const Unit* unit;

    double to_si() const;
    /// A list of exactly `count` numbers.
    VectorXd list_to_si(std::size_t count) const;
    /// A list of exactly three numbers as a vector.
    Vector3d vector_to_si() const;
};

/// A key that a map may have, and what the manual says of it. One that ends in a unit stands for
/// all units of its quantity: `sigma_mm`, too, for `sigma_um`.
struct YamlKey {
    std::string_view key;
    std::string_view of;  ///< which maps of the table have it, "points and poses"; empty: each
    std::string_view means, absent, example;
};
/// The keys of one map, or of several alike.
struct YamlKeys {
    std::string_view name;
    std::vector<YamlKey> keys;

    /// Those of one of its maps; of all of them if `map` is empty.
    std::vector<std::string> of(std::string_view map) const;
};

/// A map of which all possible keys are known. Throws InputError for any other key, with a
/// suggestion.
class YamlMap {
  public:
    YamlMap(const YamlValue& value, const std::vector<std::string>& keys);
    YamlMap(const YamlValue& value, const YamlKeys& keys, std::string_view map = "")
        : YamlMap(value, keys.of(map)) {}

    std::optional<YamlValue> find(std::string_view key) const;
    YamlValue require(std::string_view key) const;
    /// The value of `stem_<unit>`. Throws InputError if it is stated in two units.
    std::optional<YamlMeasure> find_measure(std::string_view stem) const;
    YamlMeasure require_measure(std::string_view stem) const;

  private:
    InputError missing(const std::vector<std::string>& alternatives) const;

    YamlValue value_;
    std::vector<YamlEntry> entries_;
    std::vector<std::string> keys_;  // units spelled out
};

/// The value of a key in a file of another program, whose other keys are its own.
std::optional<YamlValue> find_of(const YamlValue& map, std::string_view key);
/// The same of a key that must be there; `why` for the message: "which a camera needs".
YamlValue require_of(const YamlValue& map, std::string_view key, std::string_view why);

/// The one document of a YAML text; `path` is where it is from, for messages. Throws InputError
/// with path:line:column.
YamlValue parse_yaml(const std::string& content, const std::string& path);

}  // namespace posewise::detail
