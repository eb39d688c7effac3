#include "groups_file.hpp"

#include <algorithm>
#include <unordered_map>

#include "core/text.hpp"
#include "io/format/csv_reader.hpp"

namespace posewise::detail {
namespace {

constexpr Index no_group = -1;

/// Which field of the header is `config`; the other one is `group`.
std::size_t find_config_field(CsvReader& csv, const std::string& path) {
    if (!csv.next_row()) throw input_error_at({path}, "is empty; must begin with config,group");
    const auto& fields = csv.fields();
    if (fields.size() == 2 && fields[0] == "config" && fields[1] == "group") return 0;
    if (fields.size() == 2 && fields[0] == "group" && fields[1] == "config") return 1;
    throw input_error_at(csv.locate(0), "header must be config,group");
}

}  // namespace

std::vector<Index> read_groups(const std::string& path, const std::vector<std::string>& ids) {
    std::unordered_map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < ids.size(); ++i) places.emplace(ids[i], i);
    CsvReader csv(path);
    const std::size_t config = find_config_field(csv, path);
    std::unordered_map<std::string, Index> labels;
    std::vector<Index> groups(ids.size(), no_group);
    while (csv.next_row()) {
        if (csv.fields().size() != 2) throw input_error_at(csv.locate(0), "row must have 2 fields");
        const std::string id(csv.fields()[config]);
        const auto found = places.find(id);
        if (found == places.end()) {
            throw input_error_at(csv.locate(config), quote(id) + " is not among the candidates");
        }
        Index& group = groups[found->second];
        if (group != no_group) {
            throw input_error_at(csv.locate(config), quote(id) + " occurs twice; keep one");
        }
        group =
            labels.emplace(std::string(csv.fields()[1 - config]), static_cast<Index>(labels.size()))
                .first->second;
    }
    const auto missing = std::find(groups.begin(), groups.end(), no_group);
    if (missing != groups.end()) {
        throw input_error_at({path}, "has no group for '" +
                                         ids[static_cast<std::size_t>(missing - groups.begin())] +
                                         "'; must have one for each candidate");
    }
    return groups;
}

}  // namespace posewise::detail
