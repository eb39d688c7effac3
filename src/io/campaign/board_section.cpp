#include "board_section.hpp"

#include <fmt/format.h>

#include <array>
#include <filesystem>

#include "campaign_sections.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"

namespace posewise::detail {
namespace {

constexpr Index most_corners = 1000;
constexpr double longest = 10;  // m

using Pattern = BoardPattern::Kind;

constexpr std::array<std::pair<std::string_view, Pattern>, 4> kinds{
    {{"chessboard", Pattern::Chessboard},
     {"charuco", Pattern::Charuco},
     {"aprilgrid", Pattern::Aprilgrid},
     {"points", Pattern::Points}}};

Index read_count(const YamlValue& value, Index least) {
    const std::uint64_t count = value.natural_number();
    if (count >= static_cast<std::uint64_t>(least) && count <= most_corners) {
        return static_cast<Index>(count);
    }
    throw value.error(fmt::format("is {}; must be from {} to {}", count, least, most_corners));
}

/// `count` places, `step` apart.
std::vector<double> evenly(Index count, double step, double first = 0) {
    std::vector<double> places;
    for (Index k = 0; k < count; ++k) places.push_back(first + static_cast<double>(k) * step);
    return places;
}

/// Both edges of `count` tags.
std::vector<double> edges(Index count, double tag, double spacing) {
    std::vector<double> places;
    for (const double first : evenly(count, tag * (1 + spacing))) {
        places.insert(places.end(), {first, first + tag});
    }
    return places;
}

/// Row by row, along x first.
std::vector<Vector3d> grid(const YamlValue& board, const std::vector<double>& x,
                           const std::vector<double>& y) {
    if (x.size() * y.size() > most_corners) {
        throw board.error(
            fmt::format("has {} corners; must have at most {}", x.size() * y.size(), most_corners));
    }
    std::vector<Vector3d> corners;
    for (const double place : y) {
        for (const double along : x) corners.emplace_back(along, place, 0);
    }
    return corners;
}

/// Its frame has y upwards, as Kalibr's has, so z towards who looks at it.
void set_aprilgrid(const YamlValue& board, double tag, const YamlValue& spacing,
                   CameraSetup& setup) {
    const double ratio = spacing.number();
    if (!(ratio > 0 && ratio <= 1)) {
        throw spacing.error(fmt::format(
            "is {}; must be the gap between two tags, divided by a tag's side: above 0 to 1",
            spacing.text()));
    }
    setup.pattern.marker = tag;
    setup.pattern.dictionary = "DICT_APRILTAG_36h11";
    setup.corners = grid(board, edges(setup.pattern.columns, tag, ratio),
                         edges(setup.pattern.rows, tag, ratio));
    setup.view.is_front_plus_z = true;
    setup.first_corner = 0;
}

std::vector<Vector3d> read_points(const YamlMeasure& points) {
    const std::vector<YamlValue> items = points.value.list();
    if (items.size() < 4 || items.size() > most_corners) {
        throw points.value.error(
            fmt::format("lists {} points; must be from 4 to {}", items.size(), most_corners));
    }
    std::vector<Vector3d> corners;
    for (const YamlValue& item : items) {
        corners.push_back(YamlMeasure{item, points.unit}.vector_to_si());
        for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
            if ((corners[k] - corners.back()).norm() > 1e-6) continue;
            throw item.error(
                fmt::format("is at the place of point {}; must be at one of its own", k + 1));
        }
    }
    return corners;
}

void read_squares(const YamlValue& value, const YamlMap& board, CameraSetup& setup) {
    BoardPattern& pattern = setup.pattern;
    const YamlMeasure stated = board.require_measure("square");
    const double square = read_positive(stated, false, longest);
    if (pattern.kind == Pattern::Chessboard) {
        setup.corners = grid(value, evenly(pattern.columns, square), evenly(pattern.rows, square));
        return;
    }
    const YamlMeasure marker = board.require_measure("marker");
    pattern.marker = read_positive(marker, false, longest);
    if (!(pattern.marker < square)) {
        throw marker.value.error("is " + quote(marker.value.text()) +
                                 "; must be smaller than the squares");
    }
    const auto dictionary = board.find("dictionary");
    pattern.dictionary = dictionary ? dictionary->text() : "DICT_4X4_50";
    if (!pattern.dictionary.starts_with("DICT_")) {
        throw dictionary->error("is " + quote(pattern.dictionary) +
                                "; must be one of OpenCV's names, such as DICT_4X4_50");
    }
    if (const auto legacy = board.find("legacy")) {
        pattern.is_legacy = legacy->boolean();
        if (pattern.is_legacy && pattern.rows % 2 == 1) {
            throw legacy->error("is true with an odd number of rows; OpenCV has no such boards");
        }
    }
    // OpenCV's frame: from the outer corner, not from the first inner one.
    setup.corners = grid(value, evenly(pattern.columns - 1, square, square),
                         evenly(pattern.rows - 1, square, square));
    setup.first_corner = 0;
}

void read_pattern(const YamlValue& value, std::string_view kind, CameraSetup& setup) {
    const YamlMap board(value, keys::board, kind);
    BoardPattern& pattern = setup.pattern;
    if (pattern.kind == Pattern::Points) {
        setup.corners = read_points(board.require_measure("points"));
        return;
    }
    const Index least = pattern.kind == Pattern::Charuco ? 3 : 2;
    pattern.columns = read_count(board.require("columns"), least);
    pattern.rows = read_count(board.require("rows"), least);
    if (pattern.kind != Pattern::Aprilgrid) return read_squares(value, board, setup);
    set_aprilgrid(value, read_positive(board.require_measure("tag"), false, longest),
                  board.require("spacing"), setup);
}

/// A target of Kalibr; lengths are in m.
void read_kalibr(const YamlValue& file, const YamlValue& type, CameraSetup& setup) {
    const bool is_grid = type.is_text("aprilgrid");
    if (!is_grid && !type.is_text("checkerboard")) {
        throw type.error("is " + quote(type.text()) + "; must be checkerboard or aprilgrid");
    }
    const auto require = [&](std::string_view key) {
        return require_of(file, key, "which the board needs");
    };
    const auto length = [&](std::string_view key) {
        return read_positive({require(key), find_unit("m")}, false, longest);
    };
    BoardPattern& pattern = setup.pattern;
    pattern.kind = is_grid ? Pattern::Aprilgrid : Pattern::Chessboard;
    pattern.columns = read_count(require(is_grid ? "tagCols" : "targetCols"), 2);
    pattern.rows = read_count(require(is_grid ? "tagRows" : "targetRows"), 2);
    if (!is_grid) {
        setup.corners = grid(file, evenly(pattern.columns, length("colSpacingMeters")),
                             evenly(pattern.rows, length("rowSpacingMeters")));
        return;
    }
    if (const auto offset = find_of(file, "codeOffset"); offset && offset->number() != 0) {
        throw offset->error("is " + quote(offset->text()) + "; must be 0, the first tag's number");
    }
    const double tag = length("tagSize");
    set_aprilgrid(file, tag, require("tagSpacing"), setup);
}

std::pair<std::string_view, Pattern> kind_of(const YamlValue& value) {
    const YamlMap board(value, keys::board);
    const auto stated = board.find("kind");
    if (!stated) {
        if (board.find_measure("points")) return kinds.back();
        if (board.find_measure("marker")) {
            throw value.error("has the side of markers; must state kind: charuco");
        }
        if (board.find_measure("tag")) {
            throw value.error("has the side of tags; must state kind: aprilgrid");
        }
        if (board.find("columns")) return kinds.front();
        throw value.error("must have either columns, rows and square_mm, or points_mm, or file");
    }
    std::vector<std::string> names;
    for (const auto& kind : kinds) {
        if (stated->is_text(kind.first)) return kind;
        names.emplace_back(kind.first);
    }
    throw stated->error("is " + quote(stated->text()) + "; " + suggest(stated->text(), names));
}

/// How its corners count and how well they are known.
void read_corners(const YamlMap& board, CameraSetup& setup) {
    if (const auto sigma = board.find_measure("sigma")) {
        setup.corner_sigma = read_positive(*sigma, false, 0.1);
    }
    const auto first = board.find("first_point");
    if (!first) return;
    setup.first_corner = static_cast<Index>(first->natural_number());
    if (setup.first_corner > 1) {
        throw first->error(fmt::format("is {}; must be 0 or 1", setup.first_corner));
    }
}

void read_stated(const YamlValue& value, CameraSetup& setup) {
    const auto [name, kind] = kind_of(value);
    setup.pattern.kind = kind;
    read_pattern(value, name, setup);
}

/// A file of Kalibr, or one whose key `board` is as in a campaign.
void read_file_of(const YamlValue& asked_by, CameraSetup& setup) {
    const std::filesystem::path campaign(asked_by.location().path);
    const std::string path = (campaign.parent_path() / asked_by.text()).string();
    std::string content;
    try {
        content = read_file(path);
    } catch (const InputError& e) {
        throw asked_by.error(fmt::format("cannot be read: {}", e.what()));
    }
    const YamlValue file = parse_yaml(content, path);
    if (const auto type = find_of(file, "target_type")) return read_kalibr(file, *type, setup);
    const auto board = find_of(file, "board");
    if (!board) throw file.error("has neither target_type, as Kalibr's have, nor board");
    if (find_of(*board, "file")) throw board->error("names a file; must describe the board itself");
    read_stated(*board, setup);
    read_corners(YamlMap(*board, keys::board), setup);
}

}  // namespace

void read_board(const YamlValue& value, CameraSetup& setup) {
    if (const auto file = find_of(value, "file")) {
        const YamlMap allowed(value, keys::board, "file");
        read_file_of(*file, setup);
    } else {
        read_stated(value, setup);
    }
    read_corners(YamlMap(value, keys::board), setup);
}

}  // namespace posewise::detail
