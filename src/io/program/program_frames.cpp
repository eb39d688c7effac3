#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <set>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "target_text.hpp"

// Tools and frames that a program selects for its places.

namespace posewise::detail {
namespace {

using io::ProgramFormat;

/// Each line in small letters and without blanks, with its number.
void for_each_line(const std::string& text,
                   const std::function<void(const std::string&, long)>& take) {
    long number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string line = lower_case(text.substr(begin, end - begin));
        std::erase_if(line, [](char letter) { return letter == ' ' || letter == '\t'; });
        std::erase(line, '\r');
        take(line, ++number);
        begin = end + 1;
    }
}

/// What stands behind the marker, up to one of the letters that end it; empty: nothing does.
std::string behind(const std::string& line, std::string_view marker, std::string_view ends) {
    const std::size_t at = line.find(marker);
    if (at == std::string::npos) return "";
    const std::size_t begin = at + marker.size();
    return line.substr(begin, std::min(line.find_first_of(ends, begin), line.size()) - begin);
}

/// The tools and frames of a program, as they are selected, each once.
class Frames {
  public:
    explicit Frames(const std::string& path) : path_(path) {}

    void add_tool(const std::string& tool) { add(tool, "tool", tools_); }
    void add_frame(const std::string& frame) { add(frame, "frame", frames_); }
    [[noreturn]] void refuse(long line, const std::string& what) const {
        throw input_error_at({path_, line},
                             fmt::format("{}; places are corrected only where nothing shifts them "
                                         "or calculates their tool or frame",
                                         what));
    }

  private:
    void add(const std::string& word, const char* what, std::set<std::string>& words) {
        if (word.empty()) return;
        words.insert(word);
        if (words.size() < 2) return;
        throw input_error_at(
            {path_},
            fmt::format("moves with several {}s, {} and {}; must be of one, whose targets are "
                        "corrected together",
                        what, quote(*words.begin()), quote(*std::next(words.begin()))));
    }

    const std::string& path_;
    std::set<std::string> tools_;
    std::set<std::string> frames_;
};

// ---- FANUC ----

void read_fanuc_frames(const std::string& text, Frames& frames) {
    const auto number_of = [](const std::string& word) {
        return parse_number(word).ok() ? word : std::string();  // else a register's
    };
    for_each_line(text, [&](const std::string& line, long number) {
        for (const char* const set : {"utool[", "uframe["}) {
            if (line.starts_with(set) && line.find('=') != std::string::npos) {
                frames.refuse(number, "sets " + quote(line.substr(0, line.find('='))));
            }
        }
        frames.add_tool(number_of(behind(line, "ut:", ",")));
        frames.add_frame(number_of(behind(line, "uf:", ",")));
        const std::string selected = behind(line, "=", ";");
        if (line.starts_with("utool_num")) frames.add_tool(number_of(selected));
        if (line.starts_with("uframe_num")) frames.add_frame(number_of(selected));
    });
}

// ---- KUKA ----

/// The tool and base numbers of FDATs, by their names: "DECL FDAT FP1={TOOL_NO 1,BASE_NO 2,...}".
std::map<std::string, std::pair<std::string, std::string>> kuka_fdats(const std::string& text) {
    std::map<std::string, std::pair<std::string, std::string>> fdats;
    for_each_line(text, [&](const std::string& line, long) {
        const std::string name = behind(line, "fdat", "=");
        const std::string tool = behind(line, "tool_no", ",}");
        if (tool.empty() || name.empty()) return;
        fdats[name] = {"tool_data[" + tool + "]",
                       "base_data[" + behind(line, "base_no", ",}") + "]"};
    });
    return fdats;
}

/// The file's own FDATs and those of the .dat of the same name beside it.
std::map<std::string, std::pair<std::string, std::string>> all_kuka_fdats(const std::string& path,
                                                                          const std::string& text) {
    auto fdats = kuka_fdats(text);
    const std::string data = sibling_of(path, stem_of(path) + ".dat");
    if (lower_case(ending_of(path)) == ".dat" || !std::filesystem::is_regular_file(data)) {
        return fdats;
    }
    constexpr std::size_t most_bytes = 1 << 26;
    fdats.merge(kuka_fdats(masked(read_file(data, most_bytes), ';')));
    return fdats;
}

/// Whether a value is no stated frame: a geometric product, a sum, a function's.
bool is_calculated(std::string_view value) {
    if (value.starts_with('{')) {
        const std::size_t close = value.find('}');
        return close != value.npos && close + 1 != value.size();
    }
    return value.find_first_of(":+-*/(") != value.npos;
}

void read_kuka_frames(const std::string& path, const std::string& text, Frames& frames) {
    const auto fdats = all_kuka_fdats(path, text);
    for_each_line(text, [&](const std::string& line, long number) {
        for (const char* const set : {"$tool", "$base", "tool_data[", "base_data["}) {
            const std::size_t sign = line.find('=');
            if (!line.starts_with(set) || sign == std::string::npos) continue;
            const std::string name = line.substr(0, sign);
            const std::string value = line.substr(sign + 1);
            if (name.find('.') != std::string::npos || is_calculated(value)) {
                frames.refuse(number, "calculates " + quote(name));
            }
            if (name == "$tool") frames.add_tool(value);
            if (name == "$base") frames.add_frame(value);
        }
        if (const std::string tool = behind(line, "bas(#tool,", ")"); !tool.empty()) {
            frames.add_tool("tool_data[" + tool + "]");
        }
        if (const std::string base = behind(line, "bas(#base,", ")"); !base.empty()) {
            frames.add_frame("base_data[" + base + "]");
        }
        const std::string fdat = behind(line, "fdat_act=", "{");
        const auto found = fdats.find(fdat);
        if (found != fdats.end()) {
            frames.add_tool(found->second.first);
            frames.add_frame(found->second.second);
        } else {
            frames.add_tool(fdat);
        }
    });
    // Moves are in the .src: a place of a .dat may be of any FDAT.
    if (lower_case(ending_of(path)) != ".dat") return;
    for (const auto& [name, data] : fdats) {
        frames.add_tool(data.first);
        frames.add_frame(data.second);
    }
}

// ---- ABB ----

/// Calls `take` with the words of each move, in small letters, from its name to the semicolon.
void for_each_abb_move(const std::string& text,
                       const std::function<void(std::string_view, std::size_t)>& take) {
    const std::string lower = lower_case(text);
    for (std::size_t at = 0; at < lower.size(); ++at) {
        const bool begins = at == 0 || !is_word_letter(lower[at - 1]);
        const std::string_view word =
            begins ? first_word(std::string_view(lower).substr(at)) : std::string_view();
        constexpr const char* moves[] = {"movel",  "movej", "movec", "moveabsj", "triggl", "triggj",
                                         "triggc", "arcl",  "arcc",  "searchl",  "searchc"};
        if (std::ranges::none_of(moves, [&](const char* one) { return word.starts_with(one); })) {
            continue;
        }
        const std::size_t end = std::min(lower.find(';', at), lower.size());
        take(std::string_view(lower).substr(at, end - at), at);
    }
}

/// The last argument but for a work object and what is optional.
std::string abb_tool(std::string_view move) {
    const std::string_view word = first_word(move);
    int behind_tool = word.ends_with("sync") ? 1 : 0;  // the routine
    for (const char* const output : {"do", "ao", "go"}) {
        if (word.ends_with(output)) behind_tool = 2;  // the signal and its value
    }
    for (; behind_tool > 0; --behind_tool) move = move.substr(0, move.rfind(','));
    move = move.substr(0, move.find("\\wobj"));
    const std::size_t comma = move.rfind(',');
    if (comma == move.npos) return "";
    const std::string_view last = trim(move.substr(comma + 1));
    return std::string(trim(last.substr(0, last.find('\\'))));
}

void read_abb_frames(const std::string& text, Frames& frames) {
    for_each_line(text, [&](const std::string& line, long number) {
        for (const char* const shift : {"pdispset", "pdispon", "eoffsset", "eoffson", "\\corr"}) {
            if (line.find(shift) == std::string::npos) continue;
            frames.refuse(number, "shifts places by " + quote(shift));
        }
    });
    for_each_abb_move(text, [&](std::string_view move, std::size_t) {
        std::string words(move);
        std::erase_if(words, [](char letter) { return letter == ' ' || letter == '\t'; });
        frames.add_frame(behind(words, "\\wobj:=", ",\\\r\n"));
        const std::string tool = abb_tool(move);
        if (is_identifier(tool)) frames.add_tool(tool);
    });
}

// ---- Universal Robots ----

void read_ur_frames(const std::string& text, Frames& frames) {
    for_each_line(text, [&](const std::string& line, long number) {
        for (const char* const shift : {"path_offset_", "track_conveyor_"}) {
            if (line.find(shift) == std::string::npos) continue;
            frames.refuse(number, "shifts places by " + quote(shift));
        }
        frames.add_tool(behind(line, "set_tcp(", ""));
    });
}

// ---- The tool ----

long line_of(const std::string& text, std::size_t at) {
    return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
}

std::optional<Vector3d> numbers_at(const std::string& text, Cursor& cursor, std::size_t count) {
    const auto spans = cursor.numbers(count, ']');
    if (!spans) return std::nullopt;
    return Vector3d(number_at(text, (*spans)[0]), number_at(text, (*spans)[1]),
                    number_at(text, (*spans)[2]));
}

std::optional<Vector3d> ur_tool(const std::string& text, Cursor cursor) {
    constexpr std::size_t pose_numbers = 6;
    if (!cursor.take('(') || cursor.word() != "p" || !cursor.take('[')) return std::nullopt;
    return numbers_at(text, cursor, pose_numbers);
}

std::optional<Vector3d> kuka_tool(const std::string& text, Cursor cursor) {
    if (!cursor.take('=')) return std::nullopt;
    if (cursor.word() == "$nullframe") return Vector3d::Zero();
    if (!cursor.take('{')) return std::nullopt;
    const std::size_t end = std::min(text.find('}', cursor.at()), text.size());
    if (const std::size_t colon = text.find(':', cursor.at()); colon < end) {
        cursor = Cursor(text, colon + 1);  // {FRAME: X 0,...}
    }
    Vector3d position;
    for (const char* const name : {"x", "y", "z"}) {
        if (cursor.word() != name) return std::nullopt;
        const auto span = cursor.number();
        if (!span) return std::nullopt;
        position[name[0] - 'x'] = number_at(text, *span) / mm_per_m;
        cursor.take(',');
    }
    return position;
}

/// Where "tooldata NAME:=[TRUE,[[0,0,250],..." puts a tool that the robot holds.
std::optional<Vector3d> abb_tool_position(const std::string& text, Cursor cursor,
                                          const std::string& name) {
    const bool is_held = cursor.word() == name && cursor.take(':') && cursor.take('=') &&
                         cursor.take('[') && cursor.word() == "true" && cursor.take(',') &&
                         cursor.take('[') && cursor.take('[');
    if (!is_held) return std::nullopt;
    const auto mm = numbers_at(text, cursor, 3);
    if (!mm) return std::nullopt;
    return Vector3d(*mm / mm_per_m);
}

/// Where the text, in small letters, first has a position behind the marker.
std::optional<io::StatedTool> find_tool(
    const std::string& text, std::string_view marker,
    const std::function<std::optional<Vector3d>(const Cursor&)>& read_position) {
    for (std::size_t at = text.find(marker); at != std::string::npos;
         at = text.find(marker, at + 1)) {
        const auto position = read_position(Cursor(text, at + marker.size()));
        if (position) return io::StatedTool{line_of(text, at), *position};
    }
    return std::nullopt;
}

std::optional<io::StatedTool> abb_stated_tool(const std::string& text) {
    std::string tool;  // of the first move that names one
    std::size_t used = 0;
    for_each_abb_move(text, [&](std::string_view move, std::size_t at) {
        const std::string one = abb_tool(move);
        if (!tool.empty() || !is_identifier(one)) return;
        tool = one;
        used = at;
    });
    if (tool == "tool0") return io::StatedTool{line_of(text, used), Vector3d::Zero()};
    return find_tool(text, "tooldata",
                     [&](const Cursor& cursor) { return abb_tool_position(text, cursor, tool); });
}

}  // namespace

void check_one_frame(const std::string& path, const std::string& text, ProgramFormat format) {
    Frames frames(path);
    if (format == ProgramFormat::Fanuc) read_fanuc_frames(text, frames);
    if (format == ProgramFormat::Kuka) read_kuka_frames(path, text, frames);
    if (format == ProgramFormat::Abb) read_abb_frames(text, frames);
    if (format == ProgramFormat::Ur) read_ur_frames(text, frames);
}

std::optional<io::StatedTool> stated_tool(const std::string& text, ProgramFormat format) {
    const std::string lower = lower_case(text);
    switch (format) {
        case ProgramFormat::Kuka:
            return find_tool(lower, "$tool",
                             [&](const Cursor& cursor) { return kuka_tool(lower, cursor); });
        case ProgramFormat::Abb:
            return abb_stated_tool(lower);
        case ProgramFormat::Ur:
            return find_tool(lower, "set_tcp",
                             [&](const Cursor& cursor) { return ur_tool(lower, cursor); });
        default:
            return std::nullopt;
    }
}

}  // namespace posewise::detail
