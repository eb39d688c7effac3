#include "posewise/io/program_targets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_text.hpp"

namespace posewise::io {
namespace {

using detail::lower_case;
using detail::ProgramRules;

const ProgramRules* rules_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return &detail::fanuc_program().rules;
        case ProgramFormat::Kuka:
            return &detail::kuka_program().rules;
        case ProgramFormat::Abb:
            return &detail::abb_program().rules;
        case ProgramFormat::Ur:
            return &detail::ur_program().rules;
        default:
            return nullptr;
    }
}

bool is_name_letter(char letter) {
    return letter == '_' || letter == '$' || std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

/// The program with blanks in the place of comments and strings.
std::string masked(const std::string& content, char comment) {
    std::string text = content;
    char within = 0;
    for (char& letter : text) {
        if (letter == '\n') {
            within = 0;
        } else if (within == 0) {
            if (letter == comment || letter == '"') within = letter;
            if (within != 0) letter = ' ';
        } else {
            if (letter == within && within == '"') within = 0;
            letter = ' ';
        }
    }
    return text;
}

/// Reads on from a place in a text.
class Cursor {
  public:
    Cursor(std::string_view text, std::size_t at) : text_(text), at_(at) {}

    std::size_t at() const { return at_; }
    bool is_at_end() const { return at_ >= text_.size(); }

    void skip_blanks() {
        while (!is_at_end() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    }
    bool take(char letter) {
        skip_blanks();
        if (is_at_end() || text_[at_] != letter) return false;
        ++at_;
        return true;
    }
    std::string_view word() {
        skip_blanks();
        const std::size_t begin = at_;
        while (!is_at_end() && is_name_letter(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }
    std::optional<TextSpan> number() {
        skip_blanks();
        const std::size_t end =
            std::min(text_.find_first_not_of("+-.0123456789eE", at_), text_.size());
        const TextSpan span{at_, end};
        if (!detail::parse_number(text_.substr(at_, end - at_)).ok()) return std::nullopt;
        at_ = end;
        return span;
    }
    /// As many numbers, by commas, and the letter after them.
    std::optional<std::vector<TextSpan>> numbers(std::size_t count, char close) {
        std::vector<TextSpan> spans;
        while (spans.size() < count) {
            if (!spans.empty() && !take(',')) return std::nullopt;
            const auto span = number();
            if (!span) return std::nullopt;
            spans.push_back(*span);
        }
        if (!take(close)) return std::nullopt;
        return spans;
    }

  private:
    std::string_view text_;
    std::size_t at_;
};

/// The word that ends just before a place, blanks between them passed over.
std::string_view word_before(std::string_view text, std::size_t at) {
    while (at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t')) --at;
    std::size_t begin = at;
    while (begin > 0 && is_name_letter(text[begin - 1])) --begin;
    return text.substr(begin, at - begin);
}

class TargetReader {
  public:
    TargetReader(const std::string& path, const ProgramRules& rules, const ControllerJoints& joints)
        : path_(path), rules_(rules), joints_(joints) {
        constexpr std::size_t most_bytes = 1 << 26;
        program_.content = detail::read_file(path, most_bytes);
        for (std::size_t k = 0; k < program_.content.size(); ++k) {
            if (program_.content[k] == '\n') line_begins_.push_back(k + 1);
        }
    }

    void read_fanuc();
    void read_kuka();
    void read_abb();
    void read_ur();

    TargetProgram finish() {
        if (program_.targets.empty()) {
            throw input_error_at({path_}, "has no target in joint values; must have one");
        }
        std::ranges::sort(program_.others);
        const auto repeated = std::ranges::unique(program_.others);
        program_.others.erase(repeated.begin(), repeated.end());
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
    void leave(std::size_t at) { program_.others.push_back(place(at).line); }

    void add(const std::vector<TextSpan>& spans, const std::string& id = "") {
        JointTarget target{id, VectorXd(joints_.count()), spans};
        const FileLocation where = place(spans.front().begin);
        if (id.empty()) target.id = fmt::format("{}:{}", where.line, where.column);
        for (Index i = 0; i < joints_.count(); ++i) {
            const auto [begin, end] = spans[static_cast<std::size_t>(i)];
            const std::string_view text = std::string_view(content()).substr(begin, end - begin);
            const double value = detail::parse_number(text).value;
            target.joints[i] = detail::unit_of(rules_, joints_.motion(i)).to_si(value);
            if (detail::is_plausible(target.joints[i], detail::quantity_of(joints_.motion(i)))) {
                continue;
            }
            throw input_error_at(place(begin), fmt::format("has {:g} for joint {}, which no robot "
                                                           "reaches",
                                                           value, i + 1));
        }
        program_.targets.push_back(std::move(target));
    }

    std::set<std::string> fanuc_added_positions() const;
    void read_fanuc_position(std::size_t begin, std::size_t end,
                             const std::set<std::string>& added);

    std::size_t count() const { return static_cast<std::size_t>(joints_.count()); }

    const std::string& path_;
    const ProgramRules& rules_;
    const ControllerJoints& joints_;
    std::vector<std::size_t> line_begins_{0};
    TargetProgram program_;
};

// ---- FANUC ----

/// "3" of "P[3:over table]".
std::string fanuc_number(std::string_view text) {
    return std::string(detail::trim(text.substr(0, text.find_first_of(":]"))));
}

/// Numbers of positions that moves add to others: INC, and with an offset.
std::set<std::string> TargetReader::fanuc_added_positions() const {
    std::set<std::string> added;
    const std::string text = lower_case(content().substr(0, content().find("/POS")));
    for (std::size_t at = text.find(" p["); at != std::string::npos;
         at = text.find(" p[", at + 1)) {
        const std::string line = text.substr(at, text.find('\n', at) - at);
        const bool is_added =
            line.find("offset") != std::string::npos || line.find(" inc") != std::string::npos;
        if (is_added) added.insert(fanuc_number(line.substr(3)));
    }
    return added;
}

void TargetReader::read_fanuc() {
    const std::size_t positions = content().find("/POS");
    if (positions == std::string::npos) {
        throw input_error_at({path_}, "has no /POS; must be a program for fanuc");
    }
    if (content().find("/END", positions) == std::string::npos) {
        throw input_error_at({path_}, "has no /END; must be the whole program");
    }
    const std::set<std::string> added = fanuc_added_positions();
    const std::string moves = lower_case(content().substr(0, positions));
    for (const char* const move : {":j pr[", ":l pr[", ":c pr[", ":a pr["}) {  // in registers
        for (std::size_t at = moves.find(move); at != std::string::npos;) {
            leave(at);
            at = moves.find(move, at + 1);
        }
    }
    const auto next = [&](std::size_t from) { return content().find("P[", from); };
    for (std::size_t at = next(positions); at != std::string::npos;) {
        const std::size_t end = std::min(content().find('}', at), content().size());
        read_fanuc_position(at, end, added);
        at = next(end);
    }
}

void TargetReader::read_fanuc_position(std::size_t begin, std::size_t end,
                                       const std::set<std::string>& added) {
    const std::string number = fanuc_number(std::string_view(content()).substr(begin + 2));
    const std::size_t group = content().find("GP1", begin);
    if (added.contains(number) || group >= end) return leave(begin);
    const std::size_t other = content().find("GP", group + 3);
    const std::string_view text = std::string_view(content()).substr(0, std::min(end, other));
    std::vector<TextSpan> spans;
    for (std::size_t j = 0; j < count(); ++j) {
        const std::string name = fmt::format("J{}", j + 1);
        const std::size_t found = text.find(name, group);
        if (found == std::string_view::npos) break;
        Cursor cursor(text, found + name.size());
        const auto span = cursor.take('=') ? cursor.number() : std::nullopt;
        if (!span || cursor.word() != "deg") {
            throw input_error_at(place(found), name + " is no number of degrees; must be");
        }
        spans.push_back(*span);
    }
    if (spans.empty()) return leave(begin);
    if (spans.size() != count()) {
        throw input_error_at(place(begin),
                             fmt::format("states {} joints; must state {}", spans.size(), count()));
    }
    add(spans, fmt::format("P[{}]", number));
}

// ---- KUKA ----

void TargetReader::read_kuka() {
    const std::string text = masked(content(), ';');
    for (std::size_t at = text.find('{'); at != std::string::npos; at = text.find('{', at + 1)) {
        const std::string before = lower_case(std::string(line_before(at, text)));
        Cursor first(before, 0);
        const std::string_view word = first.word();
        const bool is_relative = word.ends_with("_rel");
        const bool is_move = word == "ptp" || word == "sptp";
        const bool is_path = word == "lin" || word == "circ" || word == "slin" || word == "scirc" ||
                             word == "spl" || is_relative;
        Cursor cursor(text, at + 1);
        std::vector<TextSpan> spans;
        bool is_cartesian = false;
        bool has_axes = false;
        const std::size_t end = std::min(text.find('}', at), text.size());
        const std::size_t colon = text.find(':', at);
        if (colon < end) cursor = Cursor(text, colon + 1);  // {E6AXIS: A1 ...}
        while (cursor.at() < end) {
            const std::string name = lower_case(std::string(cursor.word()));
            const auto span = cursor.number();
            if (!span) break;
            if (name == fmt::format("a{}", spans.size() + 1)) spans.push_back(*span);
            is_cartesian = is_cartesian || name == "x";
            has_axes = has_axes || (name.size() == 2 && name[0] == 'a');
            if (!cursor.take(',')) break;
        }
        const bool is_stated = before.ends_with('=') && before.find("axis") != std::string::npos;
        const bool is_place = before.ends_with('=') && before.find("pos") != std::string::npos;
        if (!is_relative && spans.size() == count() && (is_move || is_stated)) {
            add(spans);
        } else if (has_axes || is_relative || (is_cartesian && (is_move || is_path || is_place))) {
            leave(at);
        }
    }
}

// ---- ABB ----

void TargetReader::read_abb() {
    const std::string text = masked(content(), '!');
    for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
        Cursor joints(text, at + 1);
        if (!joints.take('[')) continue;
        Cursor place = joints;
        const auto spans = joints.numbers(count(), ']');
        if (spans && joints.take(',') && joints.take('[')) {
            add(*spans);
            continue;
        }
        // A robtarget: position, orientation, configuration.
        constexpr std::size_t three = 3;
        constexpr std::size_t four = 4;
        const bool is_robtarget = place.numbers(three, ']') && place.take(',') && place.take('[') &&
                                  place.numbers(four, ']') && place.take(',') && place.take('[') &&
                                  place.numbers(four, ']');
        if (is_robtarget) leave(at);
    }
}

// ---- Universal Robots ----

void TargetReader::read_ur() {
    const std::string text = masked(content(), '#');
    const auto is_move = [](std::string_view word) {
        return word == "movej" || word == "movel" || word == "movep";
    };
    std::set<std::string> names;  // of targets that moves take
    for (std::size_t at = text.find('('); at != std::string::npos; at = text.find('(', at + 1)) {
        if (!is_move(word_before(text, at))) continue;
        names.insert(std::string(Cursor(text, at + 1).word()));
    }
    names.erase("p");
    for (std::size_t at = text.find('['); at != std::string::npos; at = text.find('[', at + 1)) {
        if (word_before(text, at) == "p") {
            leave(at);
            continue;
        }
        std::size_t before = at;
        while (before > 0 && (text[before - 1] == ' ' || text[before - 1] == '\t')) --before;
        if (before == 0) continue;
        const char letter = text[before - 1];
        const std::string_view word = word_before(text, before - 1);
        const bool is_target = (letter == '(' && is_move(word)) ||
                               (letter == '=' && names.contains(std::string(word)));
        if (!is_target) continue;
        if (const auto spans = Cursor(text, at + 1).numbers(count(), ']')) {
            add(*spans);
        } else {
            leave(at);
        }
    }
}

/// With at least as many decimals as both the file and the format have; the text itself where it is
/// the same number then.
std::string value_text(std::string_view text, const ProgramRules& rules, Motion motion, double si) {
    const std::size_t point = text.find('.');
    const bool is_plain = text.find_first_of("eE") == std::string_view::npos;
    ProgramRules digits = rules;
    if (point != std::string_view::npos && is_plain) {
        constexpr std::size_t most = 12;  // a double holds no more of a turn
        const std::size_t decimals = std::min(most, text.size() - point - 1);
        digits.decimals = std::max(rules.decimals, static_cast<int>(decimals));
    }
    const std::string replaced = detail::joint_text(digits, motion, si);
    const double change = detail::parse_number(replaced).value - detail::parse_number(text).value;
    const bool is_same = std::abs(change) < 0.501 * std::pow(10.0, -digits.decimals);
    return is_same ? std::string(text) : replaced;
}

}  // namespace

std::vector<std::string> target_format_names() { return {"fanuc", "kuka", "abb", "ur"}; }

TargetProgram read_program_targets(const std::string& path, ProgramFormat format,
                                   const ControllerJoints& joints) {
    const ProgramRules* const rules = rules_of(format);
    if (rules == nullptr) {
        throw InputError(fmt::format("programs for {} are not corrected; must be {}",
                                     program_format_name(format),
                                     detail::list_words(target_format_names())));
    }
    joint_steps(format, joints);
    TargetReader reader(path, *rules, joints);
    if (format == ProgramFormat::Fanuc) reader.read_fanuc();
    if (format == ProgramFormat::Kuka) reader.read_kuka();
    if (format == ProgramFormat::Abb) reader.read_abb();
    if (format == ProgramFormat::Ur) reader.read_ur();
    return reader.finish();
}

std::string replace_targets(const TargetProgram& program, ProgramFormat format,
                            const ControllerJoints& joints, const std::vector<VectorXd>& values) {
    const std::string& content = program.content;
    std::string text;
    std::size_t done = 0;
    for (std::size_t k = 0; k < program.targets.size(); ++k) {
        const JointTarget& target = program.targets[k];
        for (Index i = 0; i < joints.count(); ++i) {
            const auto [begin, end] = target.values[static_cast<std::size_t>(i)];
            const std::string_view old = std::string_view(content).substr(begin, end - begin);
            const std::string value =
                value_text(old, *rules_of(format), joints.motion(i), values[k][i]);
            text.append(content, done, begin - done);
            // Columns stay where blanks in front of a value leave room for it, one blank at least.
            std::size_t longer = value.size() > old.size() ? value.size() - old.size() : 0;
            for (; longer > 0 && text.ends_with("  "); --longer) text.pop_back();
            if (value.size() < old.size() && text.ends_with("  ")) {
                text.append(old.size() - value.size(), ' ');
            }
            text += value;
            done = end;
        }
    }
    return text.append(content, done);
}

void write_program_targets(const std::string& path, const TargetProgram& program,
                           ProgramFormat format, const ControllerJoints& joints,
                           const std::vector<VectorXd>& values) {
    detail::write_file(path, replace_targets(program, format, joints, values));
}

}  // namespace posewise::io
