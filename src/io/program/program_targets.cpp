#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "posewise/io/robot_programs.hpp"
#include "target_text.hpp"

namespace posewise::io {
namespace {

using detail::Cursor;
using detail::lower_case;
using detail::masked;
using detail::ProgramRules;
using detail::word_before;

class TargetReader {
  public:
    TargetReader(const std::string& path, ProgramFormat format, const ControllerJoints& joints,
                 TargetKinds kinds)
        : path_(path),
          format_(format),
          rules_(detail::target_kind_of(format)->rules),
          joints_(joints),
          kinds_(kinds) {
        constexpr std::size_t most_bytes = 1 << 26;
        program_.content = detail::read_file(path, most_bytes);
        for (std::size_t k = 0; k < program_.content.size(); ++k) {
            if (program_.content[k] == '\n') line_begins_.push_back(k + 1);
        }
        upper_ = detail::upper_case(program_.content);
    }

    void read_fanuc();
    void check_end(const std::string& text, const std::set<std::string_view>& begins,
                   const std::string& end) const;
    void read_kuka();
    void read_abb();
    void read_ur();
    void read_ur_values(const std::string& text, std::set<std::string>& names);

    /// What tells which tools and frames its targets are of: without comments and strings.
    std::string code() const {
        if (format_ == ProgramFormat::Fanuc) return fanuc_frames();
        constexpr char abb_comment = '!';
        const char comment = format_ == ProgramFormat::Kuka  ? ';'
                             : format_ == ProgramFormat::Abb ? abb_comment
                                                             : '#';
        return masked(content(), comment);
    }

    TargetProgram finish() {
        if (program_.targets.empty() && program_.places.empty()) {
            const std::string what =
                takes_places() ? "has no target" : "has no target in joint values";
            const auto first = std::ranges::min_element(program_.others);
            if (first == program_.others.end()) {
                throw input_error_at({path_}, what + "; must have one");
            }
            throw input_error_at(
                {path_, *first},
                fmt::format("{} that can be corrected; must have one: the first of {} that stay {}",
                            what, program_.others.size(), reasons_.at(*first)));
        }
        auto& others = program_.others;
        std::ranges::sort(others);
        others.erase(std::unique(others.begin(), others.end()), others.end());
        return program_;
    }

  private:
    const std::string& content() const { return program_.content; }

    FileLocation place(std::size_t at) const {
        const auto next = std::ranges::upper_bound(line_begins_, at);
        return {path_, next - line_begins_.begin(), static_cast<long>(at - *std::prev(next)) + 1};
    }
    std::string_view line_before(std::size_t at, std::string_view text) const {
        const std::size_t begin = *std::prev(std::ranges::upper_bound(line_begins_, at));
        return detail::trim(text.substr(begin, at - begin));
    }
    /// `why` the target there stays.
    void leave(std::size_t at, const char* why = "states no number for each joint") {
        const long line = place(at).line;
        program_.others.push_back(line);
        reasons_.emplace(line, why);
    }
    /// As leave(), of coordinates.
    void leave_place(std::size_t at, const char* why) {
        leave(at, takes_places() ? why : "is a place of the tool, which --cartesian takes");
    }

    void add(const std::vector<TextSpan>& spans, const std::string& id = "") {
        const VectorXd none = VectorXd::Zero(joints_.count());
        JointTarget target{id, none, spans, none, none};
        const FileLocation where = place(spans.front().begin);
        if (id.empty()) target.id = fmt::format("{}:{}", where.line, where.column);
        for (Index i = 0; i < joints_.count(); ++i) {
            const auto [begin, end] = spans[static_cast<std::size_t>(i)];
            const std::string_view text = std::string_view(content()).substr(begin, end - begin);
            const double value = detail::parse_number(text).value;
            const detail::Unit& unit = detail::unit_of(rules_, joints_.motion(i));
            target.joints[i] = unit.to_si(value);
            target.steps[i] =
                unit.to_si(std::pow(10.0, -detail::decimals_of(text, rules_.decimals)));
            if (const int decimals = detail::decimals_of(text, 0); decimals > 0) {
                target.rounding[i] = unit.to_si(0.5 * std::pow(10.0, -decimals));
            }
            if (detail::is_plausible(target.joints[i], detail::quantity_of(joints_.motion(i)))) {
                continue;
            }
            throw input_error_at(place(begin), fmt::format("has {:g} for joint {}, which no robot "
                                                           "reaches",
                                                           value, i + 1));
        }
        program_.targets.push_back(std::move(target));
    }

    bool takes_places() const { return kinds_ == TargetKinds::JointsAndPlaces; }

    void add_place(const std::vector<TextSpan>& values,
                   const std::vector<TextSpan>& configuration = {}, const std::string& id = "") {
        const FileLocation where = place(values.front().begin);
        PlaceTarget target;
        target.id = id.empty() ? fmt::format("{}:{}", where.line, where.column) : id;
        target.values = values;
        target.configuration = configuration;
        std::vector<double> numbers;
        for (const TextSpan& span : values) numbers.push_back(detail::number_at(content(), span));
        for (const TextSpan& span : configuration) {
            constexpr double most = 1 << 20;
            const double state = detail::number_at(content(), span);
            if (state != std::floor(state) || std::abs(state) > most) {
                throw input_error_at(place(span.begin), "is no number of a configuration");
            }
            target.states.push_back(std::lround(state));
        }
        try {
            target.frame_from_tool = detail::place_of(format_, numbers);
        } catch (const InputError& error) {
            throw input_error_at(where, error.what());
        }
        program_.places.push_back(std::move(target));
    }

    /// Whether all of these are numbers that no axis is moved by.
    bool are_at_rest(const std::vector<TextSpan>& axes) const {
        return std::ranges::all_of(axes, [&](const TextSpan& span) {
            const double value = detail::number_at(content(), span);
            return value == 0 || value == 9e9;
        });
    }

    void leave_statements(const std::string& text, const char* ends,
                          const std::function<bool(const std::string&)>& is_left);
    void leave_unread(const std::string& text, char end,
                      const std::function<bool(std::string_view)>& is_of_target);
    std::map<std::string, const char*> fanuc_added_positions() const;
    std::string fanuc_frames() const;
    void read_fanuc_place(std::size_t begin, std::string_view text, const std::string& number);
    void read_kuka_aggregate(const std::string& text, std::size_t at);
    bool read_abb_robtarget(const std::string& text, std::size_t at);
    void read_fanuc_position(std::size_t begin, std::size_t end,
                             const std::map<std::string, const char*>& added);

    std::size_t count() const { return static_cast<std::size_t>(joints_.count()); }

    const std::string& path_;
    ProgramFormat format_;
    const ProgramRules& rules_;
    const ControllerJoints& joints_;
    TargetKinds kinds_;
    std::vector<std::size_t> line_begins_{0};
    std::string upper_;  ///< the content in capitals
    TargetProgram program_;
    std::map<long, const char*> reasons_;  ///< why a line is in `others`
    std::vector<TextSpan> fanuc_frames_;   ///< "UF : 0, UT : 1" of each place
};

// ---- FANUC ----

/// "3" of "P[3:over table]".
std::string fanuc_number(std::string_view text) {
    return std::string(detail::trim(text.substr(0, text.find_first_of(":]"))));
}

/// Positions that moves add to others, by their numbers: why.
std::map<std::string, const char*> TargetReader::fanuc_added_positions() const {
    std::map<std::string, const char*> added;
    const std::string text = lower_case(content().substr(0, upper_.find("/POS")));
    for (std::size_t at = text.find(" p["); at != std::string::npos;
         at = text.find(" p[", at + 1)) {
        // A circular move goes on in the next line.
        const std::string move = text.substr(at, text.find(';', at) - at);
        const bool has_offset = move.find("offset") != std::string::npos;
        if (!has_offset && move.find(" inc") == std::string::npos) continue;
        added.emplace(fanuc_number(move.substr(3)),
                      has_offset ? "is of a move with an offset" : "is of a move with INC");
    }
    return added;
}

void TargetReader::read_fanuc() {
    const std::size_t positions = upper_.find("/POS");
    if (positions == std::string::npos) {
        throw input_error_at({path_}, "has no /POS; must be a program for fanuc");
    }
    if (upper_.find("/END", positions) == std::string::npos) {
        throw input_error_at({path_}, "has no /END; must be the whole program");
    }
    const auto added = fanuc_added_positions();
    for (const char* const move : {":J PR[", ":L PR[", ":C PR[", ":A PR["}) {
        for (std::size_t at = upper_.find(move); at < positions;) {
            leave(at, "moves to a position register");
            at = upper_.find(move, at + 1);
        }
    }
    const auto next = [&](std::size_t from) { return upper_.find("P[", from); };
    for (std::size_t at = next(positions); at != std::string::npos;) {
        const std::size_t end = std::min(content().find('}', at), content().size());
        read_fanuc_position(at, end, added);
        at = next(end);
    }
}

void TargetReader::read_fanuc_position(std::size_t begin, std::size_t end,
                                       const std::map<std::string, const char*>& added) {
    const std::string number = fanuc_number(std::string_view(content()).substr(begin + 2));
    const std::size_t group = upper_.find("GP1", begin);
    if (const auto found = added.find(number); found != added.end()) {
        return leave(begin, found->second);
    }
    if (group >= end) return leave(begin, "is of another group");
    const std::size_t other = upper_.find("GP", group + 3);
    const std::string_view text = std::string_view(upper_).substr(0, std::min(end, other));
    std::vector<TextSpan> spans;
    for (std::size_t j = 0; j < count(); ++j) {
        const std::string name = fmt::format("J{}", j + 1);
        const std::size_t found = text.find(name, group);
        if (found == std::string_view::npos) break;
        Cursor cursor(text, found + name.size());
        const auto span = cursor.take('=') ? cursor.number() : std::nullopt;
        if (!span || cursor.word() != "DEG") {
            throw input_error_at(place(found), name + " is no number of degrees; must be");
        }
        spans.push_back(*span);
    }
    if (spans.empty()) {
        read_fanuc_place(begin, text, number);
        return;
    }
    if (spans.size() != count()) {
        throw input_error_at(place(begin),
                             fmt::format("states {} joints; must state {}", spans.size(), count()));
    }
    add(spans, fmt::format("P[{}]", number));
}

/// X to R of a position with CONFIG, of the first group, which ends with `text`.
void TargetReader::read_fanuc_place(std::size_t begin, std::string_view text,
                                    const std::string& number) {
    constexpr std::string_view names = "XYZWPR";
    std::vector<TextSpan> values;
    for (std::size_t at = text.find('=', begin); at != std::string_view::npos;
         at = text.find('=', at + 1)) {
        const std::string_view name = word_before(text, at);
        Cursor cursor(text, at + 1);
        const auto span = cursor.number();
        if (name.starts_with('E') && !(span && are_at_rest({*span}))) {
            return leave_place(begin, "has an external axis that is not at 0");
        }
        if (name.starts_with('E')) continue;
        if (values.size() >= names.size() || name != names.substr(values.size(), 1)) {
            return leave(begin);
        }
        if (takes_places() && (!span || cursor.word() != (values.size() < 3 ? "MM" : "DEG"))) {
            throw input_error_at(place(at),
                                 std::string(name) + " is no number of mm or degrees; must be");
        }
        if (span) values.push_back(*span);
    }
    if (values.size() != names.size()) return leave(begin);
    if (!takes_places()) return leave_place(begin, "");
    if (text.find("CONFIG", begin) == std::string_view::npos) {
        throw input_error_at(place(begin),
                             "has no CONFIG, which says with which joints it is reached; must have "
                             "one");
    }
    add_place(values, {}, fmt::format("P[{}]", number));
    const std::size_t frames = text.find("UF", begin);
    const std::size_t line = std::min(text.find('\n', frames), text.size());
    if (frames < line) fanuc_frames_.push_back({frames, line});
}

/// The program with blanks in the place of all but its selections of tools and frames and, of its
/// places, "UF : 0, UT : 1".
std::string TargetReader::fanuc_frames() const {
    std::string text = content();
    for (char& letter : text) letter = letter == '\n' ? letter : ' ';
    const auto keep = [&](std::size_t begin, std::size_t end) {
        text.replace(begin, end - begin, content(), begin, end - begin);
    };
    for (const TextSpan& frames : fanuc_frames_) keep(frames.begin, frames.end);
    const std::size_t positions = upper_.find("/POS");
    for (std::size_t begin = 0; begin < positions;) {
        const std::size_t end = std::min(content().find('\n', begin), positions);
        const std::size_t colon = std::min(content().find(':', begin), end);
        const std::string_view rest =
            std::string_view(content()).substr(colon, end - colon).substr(colon < end ? 1 : 0);
        const std::string word = lower_case(std::string(detail::trim(rest)));
        if (word.starts_with("utool") || word.starts_with("uframe")) keep(end - rest.size(), end);
        begin = end + 1;
    }
    return text;
}

/// Each line that begins with one of these words needs one that is `end`.
void TargetReader::check_end(const std::string& text, const std::set<std::string_view>& begins,
                             const std::string& end) const {
    Index open = 0;
    std::istringstream lines(lower_case(text));
    for (std::string line; std::getline(lines, line);) {
        const std::string_view word = Cursor(line, 0).word();
        open += begins.contains(word) ? 1 : word == end ? -1 : 0;
    }
    if (open <= 0) return;
    throw input_error_at({path_}, "has no " + end + " at its end; must be the whole program");
}

/// How many of what commas separate end in a number, brackets aside: "a:=[[0,A2 -90,3]" has two.
std::size_t count_listed_numbers(std::string_view text) {
    std::size_t count = 0;
    while (!text.empty()) {
        const std::size_t comma = std::min(text.find(','), text.size());
        std::string_view one = text.substr(0, comma);
        text.remove_prefix(std::min(comma + 1, text.size()));
        one = one.substr(0, one.find_last_not_of("()[]{} \t\r\n") + 1);
        const std::size_t before = one.find_last_of("()[]{} \t\r\n");
        if (before != one.npos) one.remove_prefix(before + 1);
        if (detail::parse_number(one).ok()) ++count;
    }
    return count;
}

/// Leaves the statements of a target in whose numbers nothing was found, as something else in them
/// is spoilt. One of the numbers may be, too.
void TargetReader::leave_unread(const std::string& text, char end,
                                const std::function<bool(std::string_view)>& is_of_target) {
    std::set<std::size_t> found;
    for (const JointTarget& target : program_.targets) found.insert(target.values[0].begin);
    for (const PlaceTarget& target : program_.places) found.insert(target.values[0].begin);
    const std::set<long> left(program_.others.begin(), program_.others.end());
    for (std::size_t begin = 0, next = 0; begin < text.size(); begin = next + 1) {
        next = std::min(text.find(end, begin), text.size());
        begin = std::min(text.find_first_not_of(" \t\r\n", begin), next);
        const std::string_view statement = std::string_view(text).substr(begin, next - begin);
        if (count_listed_numbers(statement) + 1 < count() || !is_of_target(statement)) continue;
        const auto target = found.lower_bound(begin);
        const std::size_t numbers = begin + statement.find(',');
        const auto line = left.lower_bound(place(numbers).line);
        const bool is_found = target != found.end() && *target < next;
        if (!is_found && (line == left.end() || *line > place(next).line)) leave(numbers);
    }
}

/// Leaves the statements that `is_left` says so of, in small letters and without blanks around.
void TargetReader::leave_statements(const std::string& text, const char* ends,
                                    const std::function<bool(const std::string&)>& is_left) {
    for (std::size_t begin = 0, next = 0; begin < text.size(); begin = next + 1) {
        next = std::min(text.find_first_of(ends, begin), text.size());
        begin = std::min(text.find_first_not_of(" \t\r\n", begin), next);
        const std::string statement(detail::trim(text.substr(begin, next - begin)));
        if (is_left(lower_case(statement))) leave(begin);
    }
}

/// Whether a value is assigned to one of these components of a variable, "x.a1 = 10", by the sign.
bool assigns_component(const std::string& statement, const std::string& sign,
                       std::string_view components) {
    const std::size_t at = statement.find(sign);
    if (at == std::string::npos || statement.compare(at, 2, "==") == 0) return false;
    std::string_view left = detail::trim(std::string_view(statement).substr(0, at));
    if (const std::size_t blank = left.rfind(' '); blank != left.npos)
        left.remove_prefix(blank + 1);
    const std::size_t dot = left.find('.');
    if (dot == std::string_view::npos || left.starts_with('$')) return false;  // a frame of KUKA
    return detail::is_word(detail::first_word(left.substr(dot + 1)), components);
}

// ---- KUKA ----

/// The numbers of an aggregate, "{E6POS: X 1.0,...}".
struct KukaAggregate {
    std::vector<TextSpan> axes;             ///< A1, A2, ... in this order
    std::map<std::string, TextSpan> named;  ///< all, by lower case
    bool is_whole = true;                   ///< all of it are numbers
    bool has_axes = false;                  ///< numbers or not
};

KukaAggregate read_kuka_numbers(const std::string& text, std::size_t at) {
    const std::size_t end = std::min(text.find('}', at), text.size());
    const std::size_t colon = text.find(':', at);
    Cursor cursor(text, colon < end ? colon + 1 : at + 1);
    KukaAggregate aggregate;
    while (cursor.at() < end) {
        const std::string name = lower_case(std::string(cursor.word()));
        const auto span = cursor.number();
        aggregate.is_whole = span.has_value();
        aggregate.has_axes |= name.size() == 2 && name[0] == 'a' && name[1] >= '1';
        if (!span) break;
        aggregate.named.emplace(name, *span);
        if (name == fmt::format("a{}", aggregate.axes.size() + 1)) aggregate.axes.push_back(*span);
        if (!cursor.take(',')) break;
    }
    return aggregate;
}

/// Whether a frame stands before or behind the aggregate, "{X 1,...}:OFFSET".
bool is_kuka_product(const std::string& text, std::size_t at) {
    Cursor behind(text, std::min(text.find('}', at), text.size() - 1) + 1);
    const std::size_t before = text.find_last_not_of(" \t", at == 0 ? 0 : at - 1);
    return behind.take(':') || (at > 0 && before != std::string::npos && text[before] == ':');
}

void TargetReader::read_kuka_aggregate(const std::string& text, std::size_t at) {
    const std::string before = lower_case(std::string(line_before(at, text)));
    const std::string_view word = Cursor(before, 0).word();
    const bool is_relative = word.ends_with("_rel");
    const bool is_move = word == "ptp" || word == "sptp";
    const bool is_path = word == "lin" || word == "circ" || word == "slin" || word == "scirc" ||
                         word == "spl" || is_relative;
    const KukaAggregate aggregate = read_kuka_numbers(text, at);
    const bool is_axis_value = before.ends_with('=') && before.find("axis") != std::string::npos;
    const bool is_place = before.ends_with('=') && before.find("pos") != std::string::npos;
    if (!is_relative && aggregate.axes.size() == count() && (is_move || is_axis_value)) {
        return add(aggregate.axes);
    }
    const bool is_cartesian = aggregate.named.contains("x") && (is_move || is_path || is_place);
    if (is_relative) return leave(at, "is relative to the position before");
    if (is_cartesian && aggregate.is_whole && is_kuka_product(text, at)) {
        return leave_place(at, "is multiplied by another frame");
    }
    if (!is_cartesian || !aggregate.is_whole) {
        if (is_cartesian || aggregate.has_axes) leave(at);
        return;
    }
    if (!takes_places()) return leave_place(at, "");
    std::vector<TextSpan> values;
    std::vector<TextSpan> external;
    for (const char* const name : {"x", "y", "z", "a", "b", "c"}) {
        const auto found = aggregate.named.find(name);
        if (found == aggregate.named.end()) {
            return leave(at, "states fewer than six coordinates");
        }
        values.push_back(found->second);
    }
    for (const auto& [name, span] : aggregate.named) {
        if (name.starts_with('e')) external.push_back(span);
    }
    if (!are_at_rest(external)) return leave(at, "has an external axis that is not at 0");
    const auto turns = aggregate.named.find("t");
    add_place(values, turns == aggregate.named.end() ? std::vector<TextSpan>{}
                                                     : std::vector<TextSpan>{turns->second});
}

void TargetReader::read_kuka() {
    const std::string text = masked(content(), ';');
    check_end(text, {"def"}, "end");
    check_end(text, {"defdat"}, "enddat");
    for (std::size_t at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
        read_kuka_aggregate(text, at);
    }
    leave_statements(text, "\n", [](const std::string& statement) {
        return assigns_component(statement, "=", "a1 a2 a3 a4 a5 a6 x y z a b c");
    });
    leave_unread(text, '\n', [this](std::string_view statement) {
        const std::string line = lower_case(std::string(statement));
        const bool is_declared = line.find("axis ") != line.npos || line.find("pos ") != line.npos;
        return is_declared || detail::is_word(Cursor(line, 0).word(), rules_.moves);
    });
}

// ---- ABB ----

/// A robtarget: position, orientation, configuration, external axes. Whether it is one.
bool TargetReader::read_abb_robtarget(const std::string& text, std::size_t at) {
    constexpr std::size_t three = 3;
    constexpr std::size_t four = 4;
    Cursor cursor(text, at);
    const auto position = cursor.numbers(three, ']');
    if (!position || !cursor.take(',') || !cursor.take('[')) return false;
    const auto orientation = cursor.numbers(four, ']');
    if (!orientation || !cursor.take(',') || !cursor.take('[')) return false;
    const auto configuration = cursor.numbers(four, ']');
    if (!configuration) return false;
    constexpr std::size_t six = 6;
    const auto external =
        cursor.take(',') && cursor.take('[') ? cursor.numbers(six, ']') : std::nullopt;
    if (!takes_places() || !external) {
        leave_place(at, "has no six external axes");
        return true;
    }
    if (!are_at_rest(*external)) {
        leave(at, "has an external axis that is not at 0 or 9E9");
        return true;
    }
    std::vector<TextSpan> values = *position;
    values.insert(values.end(), orientation->begin(), orientation->end());
    add_place(values, {(*configuration)[0], (*configuration)[1], (*configuration)[2]});
    return true;
}

/// Whether a declaration of a target or a move is what states it, whatever stands there.
bool is_abb_target(std::string_view text) {
    const std::string before = lower_case(std::string(text));
    return before.find("jointtarget") != std::string::npos ||
           before.find("robtarget") != std::string::npos ||
           before.find("move") != std::string::npos;
}

/// What stands before the outermost bracket that is open at this one, in its line and statement.
std::string_view abb_statement_before(std::string_view text, std::size_t at) {
    std::size_t outermost = at;
    long depth = 0;  // how many brackets were closed and not yet opened, seen from the end
    for (std::size_t k = at; k > 0 && text[k - 1] != ';'; --k) {
        if (text[k - 1] == ']') ++depth;
        if (text[k - 1] != '[') continue;
        if (depth == 0) outermost = k - 1;
        if (depth > 0) --depth;
    }
    const std::size_t begin = text.find_last_of(";\n", outermost) + 1;
    return text.substr(begin, outermost - begin);
}

void TargetReader::read_abb() {
    const std::string text = masked(content(), '!');
    check_end(text, {"module"}, "endmodule");
    for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
        Cursor joints(text, at + 1);
        if (!joints.take('[')) continue;
        const std::size_t inner = joints.at();
        if (Cursor(text, inner).take('[')) continue;  // an array, whose elements follow
        const auto spans = joints.numbers(count(), ']');
        if (spans && joints.take(',') && joints.take('[')) {
            add(*spans);
        } else if (!read_abb_robtarget(text, inner) &&
                   is_abb_target(abb_statement_before(text, at))) {
            leave(at);
        }
    }
    leave_statements(text, ";\n", [](const std::string& statement) {
        const bool is_stated = statement.find(":=") != std::string::npos;
        return assigns_component(statement, ":=", "robax trans rot") ||
               (is_stated && statement.find("robjoint ") != std::string::npos) ||
               statement.find("calcjointt") != std::string::npos;
    });
    leave_unread(text, ';', &is_abb_target);
}

// ---- Universal Robots ----

/// Adds names whose lists others take, "q2 = q1". Leaves values of names that are no list.
void TargetReader::read_ur_values(const std::string& text, std::set<std::string>& names) {
    struct Assignment {
        std::string name;
        std::string value;
        std::size_t at = 0;
        bool is_whole = true;  ///< not one of its numbers, "q[0] = 1"
    };
    std::vector<Assignment> assignments;
    for (std::size_t begin = 0, next = 0; begin < text.size(); begin = next + 1) {
        next = std::min(text.find('\n', begin), text.size());
        std::string_view line = detail::trim(std::string_view(text).substr(begin, next - begin));
        for (const std::string_view scope : {"global ", "local "}) {
            if (line.starts_with(scope)) line = detail::trim(line.substr(scope.size()));
        }
        const std::string_view name = detail::first_word(line);
        const std::string_view rest = detail::trim(line.substr(name.size()));
        const std::size_t sign = rest.find('=');
        const bool is_whole = sign == 0;
        if (name.empty() || sign == std::string_view::npos || rest.substr(sign, 2) == "==" ||
            (!is_whole && !rest.starts_with('['))) {
            continue;
        }
        assignments.push_back(
            {std::string(name), std::string(detail::trim(rest.substr(sign + 1))), begin, is_whole});
    }
    for (bool is_new = true; is_new;) {
        is_new = false;
        for (const Assignment& one : assignments) {
            const bool is_alias = one.is_whole && detail::is_identifier(one.value);
            if (is_alias && names.contains(one.name)) is_new |= names.insert(one.value).second;
        }
    }
    for (const Assignment& one : assignments) {
        const bool is_read =
            one.is_whole && (detail::is_identifier(one.value) || one.value.starts_with('[') ||
                             one.value.starts_with("p["));
        if (names.contains(one.name) && !is_read) leave(one.at);
    }
}

void TargetReader::read_ur() {
    const std::string text = masked(content(), '#');
    check_end(text, {"def", "while", "if", "for", "thread"}, "end");
    const auto is_move = [](std::string_view word) {
        return word == "movej" || word == "movel" || word == "movep";
    };
    std::set<std::string> names;     // targets that moves take
    std::set<std::string> streamed;  // targets that servoj takes: they stay
    for (std::size_t at = text.find('('); at != std::string::npos; at = text.find('(', at + 1)) {
        const std::string_view word = word_before(text, at);
        const std::string_view name = Cursor(text, at + 1).word();
        if (!detail::is_identifier(name)) continue;
        if (is_move(word)) names.emplace(name);
        if (word == "servoj") streamed.emplace(name);
    }
    names.erase("p");
    read_ur_values(text, names);
    for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
        const bool is_pose = word_before(text, at) == "p";
        std::size_t before = is_pose ? text.rfind('p', at) : at;
        while (before > 0 && (text[before - 1] == ' ' || text[before - 1] == '\t')) --before;
        const char letter = before == 0 ? '\0' : text[before - 1];
        const std::string_view word = before == 0 ? "" : word_before(text, before - 1);
        const bool is_target = (letter == '(' && is_move(word)) ||
                               (letter == '=' && names.contains(std::string(word)));
        if (is_target && is_pose && !takes_places()) {
            leave_place(at, "");
            continue;
        }
        if (!is_target) {
            const bool is_streamed = (letter == '(' && word == "servoj") ||
                                     (letter == '=' && streamed.contains(std::string(word)));
            if (is_streamed || (is_pose && word != "set_tcp")) leave(at);  // which is the tool
            continue;
        }
        constexpr std::size_t pose_numbers = 6;
        const auto spans = Cursor(text, at + 1).numbers(is_pose ? pose_numbers : count(), ']');
        if (!spans) {
            leave(at);
        } else if (is_pose) {
            add_place(*spans);
        } else {
            add(*spans);
        }
    }
    leave_unread(text, '\n', [&](std::string_view statement) {
        for (std::size_t at = 0; at < statement.size(); ++at) {
            const std::string_view word = detail::first_word(statement.substr(at));
            if (is_move(word) || word == "servoj" || names.contains(std::string(word))) return true;
            at += word.size();
        }
        return false;
    });
}

/// The joint value in the file's unit.
std::string value_text(std::string_view text, const ProgramRules& rules, Motion motion, double si) {
    const detail::Unit& unit = detail::unit_of(rules, motion);
    return detail::number_text(text, rules.decimals, si * unit.divisor / unit.factor);
}

}  // namespace

std::vector<std::string> target_format_names() { return {"fanuc", "kuka", "abb", "ur"}; }

TargetProgram read_program_targets(const std::string& path, ProgramFormat format,
                                   const ControllerJoints& joints, TargetKinds kinds) {
    const detail::ProgramKind* const kind = detail::target_kind_of(format);
    if (kind == nullptr) {
        throw InputError(fmt::format("programs for {} are not corrected; must be {}",
                                     program_format_name(format),
                                     detail::list_words(target_format_names())));
    }
    joint_steps(format, joints);
    const detail::ProgramFile file(path);
    for (const detail::TextLine& line : file.lines()) kind->check(line);
    if (kind->check_all != nullptr) kind->check_all(file.lines());
    TargetReader reader(path, format, joints, kinds);
    if (format == ProgramFormat::Fanuc) reader.read_fanuc();
    if (format == ProgramFormat::Kuka) reader.read_kuka();
    if (format == ProgramFormat::Abb) reader.read_abb();
    if (format == ProgramFormat::Ur) reader.read_ur();
    TargetProgram program = reader.finish();
    if (program.places.empty()) return program;
    const std::string code = reader.code();
    detail::check_one_frame(path, code, format);
    program.tool = detail::stated_tool(code, format);
    return program;
}

std::string replace_targets(const TargetProgram& program, ProgramFormat format,
                            const ControllerJoints& joints, const std::vector<VectorXd>& values,
                            const std::vector<CorrectedPlace>& places) {
    const std::string_view content = program.content;
    const ProgramRules& rules = detail::target_kind_of(format)->rules;
    std::vector<std::pair<TextSpan, std::string>> texts;
    for (std::size_t k = 0; k < program.targets.size(); ++k) {
        for (Index i = 0; i < joints.count(); ++i) {
            const TextSpan span = program.targets[k].values[static_cast<std::size_t>(i)];
            const std::string_view old = content.substr(span.begin, span.end - span.begin);
            texts.emplace_back(span, value_text(old, rules, joints.motion(i), values[k][i]));
        }
    }
    for (std::size_t k = 0; k < places.size(); ++k) {
        std::ranges::move(detail::place_texts(program, k, format, places[k]),
                          std::back_inserter(texts));
    }
    std::ranges::stable_sort(texts, {}, [](const auto& one) { return one.first.begin; });
    std::string text;
    std::size_t done = 0;
    for (const auto& [span, value] : texts) {
        text.append(content, done, span.begin - done);
        // Columns stay where blanks in front of a value leave room for it, one blank at least.
        const std::size_t before = span.end - span.begin;
        std::size_t longer = value.size() > before ? value.size() - before : 0;
        for (; longer > 0 && text.ends_with("  "); --longer) text.pop_back();
        if (value.size() < before && text.ends_with("  ")) text.append(before - value.size(), ' ');
        text += value;
        done = span.end;
    }
    return text.append(content, done);
}

void write_program_targets(const std::string& path, const TargetProgram& program,
                           ProgramFormat format, const ControllerJoints& joints,
                           const std::vector<VectorXd>& values,
                           const std::vector<CorrectedPlace>& places) {
    detail::write_file(path, replace_targets(program, format, joints, values, places));
}

}  // namespace posewise::io
