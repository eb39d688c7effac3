#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "io/campaign/keys.hpp"
#include "io/format/atomic_file.hpp"
#include "support/places.hpp"

namespace posewise {
namespace {

std::string table_of(const detail::YamlKeys& keys) {
    std::string table = "| key | means | default | example |\n|---|---|---|---|\n";
    for (const detail::YamlKey& key : keys.keys) {
        const std::string of = key.of.empty() ? "" : fmt::format("of {}: ", key.of);
        table += fmt::format("| `{}` | {}{} | {} | {} |\n", key.key, of, key.means, key.absent,
                             key.example);
    }
    return table;
}

/// The manual with the table of its readers under each `<!-- keys: NAME -->`.
std::string with_tables(const std::string& manual) {
    constexpr std::string_view mark = "<!-- keys: ";
    std::string text;
    std::istringstream lines(manual);
    bool is_in_table = false;
    for (std::string line; std::getline(lines, line);) {
        is_in_table = is_in_table && line.starts_with('|');
        if (is_in_table) continue;
        text += line + '\n';
        if (!line.starts_with(mark)) continue;
        is_in_table = true;
        const std::string name = line.substr(mark.size(), line.find(" -->") - mark.size());
        for (const detail::YamlKeys* const keys : detail::keys::all()) {
            if (keys->name == name) text += table_of(*keys);
        }
    }
    return text;
}

TEST(Manual, HasTheKeysThatTheReadersTake) {
    const std::string path = source_folder() + "/designs/README.md";
    const std::string manual = detail::read_file(path, 1 << 20);
    const std::string expected = with_tables(manual);
    if (std::getenv("POSEWISE_WRITE_MANUAL") != nullptr) std::ofstream(path) << expected;
    EXPECT_TRUE(manual == expected)
        << "run this test with POSEWISE_WRITE_MANUAL=1 to write the tables of designs/README.md";
    for (const detail::YamlKeys* const keys : detail::keys::all()) {
        EXPECT_NE(manual.find(fmt::format("<!-- keys: {} -->\n", keys->name)), std::string::npos)
            << keys->name;
    }
}

TEST(Manual, HasAMapForEveryKey) {
    // A word that no map is called would hide its keys from all readers.
    for (const char* const map : {"gravity", "harmonics", "axis_tilt", "compliance"}) {
        EXPECT_FALSE(detail::keys::terms.of(map).empty()) << map;
    }
    EXPECT_EQ(detail::keys::terms.of("gravity"), (std::vector<std::string>{"direction", "joints"}));
    EXPECT_EQ(detail::keys::places.of("base"),
              (std::vector<std::string>{"position_mm", "rpy_deg", "known"}));
    EXPECT_EQ(
        detail::keys::sensor.of("sockets"),
        (std::vector<std::string>{"kind", "sigma_mm", "targets", "sockets", "known_sockets"}));
}

}  // namespace
}  // namespace posewise
