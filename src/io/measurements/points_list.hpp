#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/format/units.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"

/// Lists of points as instruments' programs write them.
namespace posewise::detail {

/// Units of points: those of all lengths, and inches, which nothing else here is stated in.
std::vector<std::string> point_unit_names();
/// nullptr if there is none of that name (or `in`).
const Unit* find_point_unit(std::string_view name);

struct NamedPoint {
    std::string name;   ///< empty: the list has none
    Vector3d position;  ///< m; without a unit as it stands there
    FileLocation place;
    std::string time{};         ///< as it stands there; empty: not stated
    std::string temperature{};  ///< likewise
};

struct PointsList {
    std::vector<NamedPoint> points;
    const Unit* unit = nullptr;       ///< as stated in the header; nullptr: not
    std::vector<std::string> unused;  ///< names of columns that nothing is known about
    bool has_time = false;
    bool has_temperature = false;
};

/// Whether the text is a list of points rather than a table with the column `config`: by its first
/// row. `is_expected`: whatever is no such table.
bool is_points_list(const std::string& path, const std::string& content,
                    const std::vector<std::string>& joints, bool is_expected);

/// Reads x, y, z, `name x y z`, `group name x y z` or `collection group name x y z`, separated by
/// commas, semicolons, tabs or blanks, or columns under a header with x, y and z (`X`, `x_mm`,
/// `X [mm]`, `Meas X`), and a name, `time` and `temperature_C`. Lines that begin with `//` or `#`
/// are comments. `unit` is that of a list without header or unit in it; nullptr: not known. Throws
/// InputError with path:line:column for anything else.
PointsList read_points_list(const std::string& path, std::string content, const Unit* unit);

}  // namespace posewise::detail
