#include "board_section.hpp"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <cmath>

#include "camera_file.hpp"
#include "campaign_sections.hpp"
#include "io/format/text.hpp"
#include "io/format/xml_document.hpp"
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
    return static_cast<Index>(
        value.natural_number(static_cast<std::uint64_t>(least), most_corners));
}

/// Side of a square, marker or tag.
double read_side(const YamlMeasure& measure) {
    constexpr double shortest = 2e-4;  // m: no printer makes a smaller one, and metres look so
    const double side = read_positive(measure, false, longest);
    if (side >= shortest) return side;
    throw measure.value.error(fmt::format(
        "is {}; must be from {:g} to {:g} {}, as what can be printed (in metres its key ends in "
        "_m)",
        quote(measure.value.text()), measure.unit->from_si(shortest),
        measure.unit->from_si(longest), measure.unit->name));
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
    const double square = read_side(stated);
    if (pattern.kind == Pattern::Chessboard) {
        setup.corners = grid(value, evenly(pattern.columns, square), evenly(pattern.rows, square));
        return;
    }
    const YamlMeasure marker = board.require_measure("marker");
    pattern.marker = read_side(marker);
    if (!(pattern.marker < square)) {
        throw marker.value.error("is " + quote(marker.value.text()) +
                                 "; must be smaller than the squares");
    }
    constexpr double most_of_square = 0.9;  // else the squares' corners have no white about them
    if (pattern.marker > most_of_square * square * (1 + 1e-9)) {
        throw marker.value.error(
            fmt::format("is {} of squares of {}; must be at most 0.9 of them: larger markers touch "
                        "the corners, "
                        "which are then not found",
                        quote(marker.value.text()), stated.value.text()));
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
    set_aprilgrid(value, read_side(board.require_measure("tag")), board.require("spacing"), setup);
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
        return read_side({require(key), find_unit("m")});
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
    setup.first_corner = static_cast<Index>(first->natural_number(0, 1));
}

void read_stated(const YamlValue& value, CameraSetup& setup) {
    const auto [name, kind] = kind_of(value);
    setup.pattern.kind = kind;
    read_pattern(value, name, setup);
}

/// What OpenCV's programs say of a board: counts of inner corners, and a size without a unit.
struct OpencvBoard {
    std::uint64_t columns = 0, rows = 0;
    double square = 0;
    std::string pattern = "CHESSBOARD";
};

/// What went before a calibration, or what it wrote.
constexpr std::array<std::array<const char*, 3>, 2> opencv_keys{
    {{"BoardSize_Width", "BoardSize_Height", "Square_Size"},
     {"board_width", "board_height", "square_size"}}};
constexpr const char* opencv_pattern = "Calibrate_Pattern";

/// Nothing: the file says nothing of a board.
std::optional<OpencvBoard> find_opencv_board(const YamlValue& file) {
    const YamlValue settings = find_of(file, "Settings").value_or(file);
    for (const auto& [width, height, square] : opencv_keys) {
        const auto columns = find_of(settings, width);
        if (!columns) continue;
        const char* const why = "which the board needs";
        OpencvBoard board{columns->natural_number(),
                          require_of(settings, height, why).natural_number(),
                          require_of(settings, square, why).number()};
        if (const auto pattern = find_of(settings, opencv_pattern)) board.pattern = pattern->text();
        return board;
    }
    return std::nullopt;
}

/// The same of XML, whose texts may be in quotation marks.
OpencvBoard read_opencv_xml(const std::string& path) {
    const XmlDocument document(path);
    pugi::xml_node settings = document.root();
    if (const auto nested = settings.child("Settings")) settings = nested;
    const auto text_of = [&](const char* key) {
        std::string text = settings.child_value(key);
        std::erase_if(text, [](char c) { return c == '"' || std::isspace(c) != 0; });
        return text;
    };
    for (const auto& keys : opencv_keys) {
        if (!settings.child(keys[0])) continue;
        std::array<double, 3> numbers{};
        for (std::size_t k = 0; k < keys.size(); ++k) {
            const std::string text = text_of(keys[k]);
            const ParsedNumber number = parse_number(text);
            const bool is_counted = k == 2 || number.value == std::floor(number.value);
            if (!number.ok() || !(number.value > 0 && number.value <= 1e6) || !is_counted) {
                throw document.error(settings, fmt::format("has no {}, a {} above 0", keys[k],
                                                           k < 2 ? "whole number" : "number"));
            }
            numbers[k] = number.value;
        }
        OpencvBoard board{static_cast<std::uint64_t>(numbers[0]),
                          static_cast<std::uint64_t>(numbers[1]), numbers[2]};
        if (settings.child(opencv_pattern)) board.pattern = text_of(opencv_pattern);
        return board;
    }
    throw document.error(settings, "has no BoardSize_Width or board_width, as OpenCV's have");
}

/// `value`: the board in the campaign, which says in what unit its size is.
void read_opencv(const YamlValue& value, const YamlValue& asked_by, const OpencvBoard& found,
                 CameraSetup& setup) {
    if (found.pattern != "CHESSBOARD") {
        throw asked_by.error("is of a board " + quote(found.pattern) +
                             "; must be CHESSBOARD, state others by columns, rows and points_mm");
    }
    for (const std::uint64_t count : {found.columns, found.rows}) {
        if (count >= 2 && count <= static_cast<std::uint64_t>(most_corners)) continue;
        throw asked_by.error(fmt::format("has {} corners in a row or column; must be from 2 to {}",
                                         count, most_corners));
    }
    const auto stated = YamlMap(value, keys::board, "file").find_measure("square");
    if (!stated) {
        throw asked_by.error(fmt::format(
            "has squares of {:g}, in a unit that OpenCV does not write; must state square_mm, too",
            found.square));
    }
    const double square = read_side(*stated);
    const auto agrees = [&](double unit) {
        return std::abs(found.square * unit - square) <= 1e-6 * square;
    };
    if (!agrees(1) && !agrees(1e-2) && !agrees(1e-3)) {
        throw stated->value.error(
            fmt::format("is {}, the file says {:g}; must be that in mm, cm or m",
                        quote(stated->value.text()), found.square));
    }
    setup.pattern.kind = Pattern::Chessboard;
    setup.pattern.columns = static_cast<Index>(found.columns);
    setup.pattern.rows = static_cast<Index>(found.rows);
    setup.corners =
        grid(value, evenly(setup.pattern.columns, square), evenly(setup.pattern.rows, square));
}

/// A file of Kalibr or of OpenCV, or one whose key `board` is as in a campaign.
void read_file_of(const YamlValue& value, const YamlValue& asked_by, CameraSetup& setup) {
    const NamedFile named = read_named_file(asked_by);
    if (named.content.starts_with('<')) {
        return read_opencv(value, asked_by, read_opencv_xml(named.path), setup);
    }
    const YamlValue file = parse_opencv_yaml(named);
    if (const auto found = find_opencv_board(file)) {
        return read_opencv(value, asked_by, *found, setup);
    }
    if (const auto square = YamlMap(value, keys::board, "file").find_measure("square")) {
        throw square->value.error("is stated beside a file that has it; must be left out");
    }
    if (const auto type = find_of(file, "target_type")) return read_kalibr(file, *type, setup);
    const auto board = find_of(file, "board");
    if (!board) {
        throw file.error(
            "has neither target_type, as Kalibr's have, nor BoardSize_Width, as OpenCV's, nor "
            "board");
    }
    if (find_of(*board, "file")) throw board->error("names a file; must describe the board itself");
    read_stated(*board, setup);
    read_corners(YamlMap(*board, keys::board), setup);
}

}  // namespace

void read_board(const YamlValue& value, CameraSetup& setup) {
    if (const auto file = find_of(value, "file")) {
        const YamlMap allowed(value, keys::board, "file");
        read_file_of(value, *file, setup);
    } else {
        read_stated(value, setup);
    }
    read_corners(YamlMap(value, keys::board), setup);
}

}  // namespace posewise::detail
