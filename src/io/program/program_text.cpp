#include "program_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

char capital(char letter) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
}

bool is_same_letter(char a, char b) { return capital(a) == capital(b); }

/// Throws InputError where `number` is one that `is_possible` is not true of.
template <typename IsPossible>
void check_amount(const TextLine& line, std::string_view shown, std::string_view number,
                  const IsPossible& is_possible, std::string_view rule) {
    const ParsedNumber parsed = parse_number(trim(number));
    if (!parsed.ok() || is_possible(parsed.value)) return;
    throw line.error(fmt::format("has {}; must {}", quote(trim(shown)), rule));
}

}  // namespace

std::string lower_case(std::string text) {
    for (char& letter : text) {
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    return text;
}

std::string upper_case(std::string text) {
    std::ranges::transform(text, text.begin(), &capital);
    return text;
}

bool is_word(std::string_view text, std::string_view words) {
    while (!words.empty()) {
        const std::size_t end = std::min(words.find(' '), words.size());
        std::string_view word = words.substr(0, end);
        std::string_view compared = text;
        if (word.ends_with('*')) {
            word.remove_suffix(1);
            compared = text.substr(0, word.size());
        }
        if (std::ranges::equal(compared, word, is_same_letter)) return true;
        words.remove_prefix(std::min(end + 1, words.size()));
    }
    return false;
}

bool is_word_letter(char letter) {
    return letter == '_' || letter == '$' || std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

std::string_view word_before(std::string_view text, std::size_t at) {
    while (at > 0 && (text[at - 1] == ' ' || text[at - 1] == '\t')) --at;
    std::size_t begin = at;
    while (begin > 0 && is_word_letter(text[begin - 1])) --begin;
    return text.substr(begin, at - begin);
}

std::string_view first_word(std::string_view text) {
    return text.substr(
        0, static_cast<std::size_t>(std::ranges::find_if_not(text, is_word_letter) - text.begin()));
}

const Unit& unit_of(const ProgramRules& rules, Motion motion) {
    const bool turns = motion == Motion::Rotation;
    return *find_unit(rules.is_in_radians ? (turns ? "rad" : "m") : (turns ? "deg" : "mm"));
}

std::string legal_name(std::string_view text, std::size_t longest, bool is_upper,
                       std::string_view words) {
    std::string name;
    for (const char letter : text) {
        const bool is_legal = is_identifier('_' + std::string(1, letter));
        name += is_legal ? (is_upper ? capital(letter) : letter) : '_';
    }
    name.erase(0, std::min(name.find_first_not_of('_'), name.size()));
    name = name.substr(0, longest);
    const bool has_letter = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0;
    if (!has_letter || is_word(name, words)) name.insert(0, is_upper ? "P_" : "p_");
    return name.substr(0, longest);
}

std::string comment_text(std::string_view text, std::size_t longest) {
    std::string comment;
    for (const char letter : text) {
        const bool is_plain =
            letter >= ' ' && letter <= '~' &&
            std::string_view("\"'\\[]{}<>;").find(letter) == std::string_view::npos;
        comment += is_plain ? letter : '_';
    }
    return std::string(trim(comment.substr(0, longest)));
}

std::string stem_of(const std::string& path) { return std::filesystem::path(path).stem().string(); }

std::string ending_of(const std::string& path) {
    return std::filesystem::path(path).extension().string();
}

std::string sibling_of(const std::string& path, const std::string& name) {
    return (std::filesystem::path(path).parent_path() / name).string();
}

std::string joint_text(const ProgramRules& rules, Motion motion, double si) {
    const Unit& unit = unit_of(rules, motion);
    const std::string text =
        fmt::format("{:.{}f}", si * unit.divisor / unit.factor, rules.decimals);
    const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
    return is_zero && text[0] == '-' ? text.substr(1) : text;
}

std::string joints_text(const ProgramRules& rules, const ControllerJoints& joints,
                        const VectorXd& values, std::string_view separator) {
    std::string text;
    for (Index i = 0; i < values.size(); ++i) {
        if (i > 0) text += separator;
        text += joint_text(rules, joints.motion(i), values[i]);
    }
    return text;
}

std::string seconds_text(double seconds) {
    std::string text = fmt::format("{:.3f}", seconds);
    while (text.ends_with('0') && !text.ends_with(".0")) text.pop_back();
    return text;
}

double dwell_of(const ProgramRules& rules, const io::RobotProgram& program,
                const io::ProgramStop& stop) {
    constexpr double rounding = 1e-6;  // of a step: 0.07 s are 7 steps of 0.01 s
    if (!stop.is_measured) return 0;
    const double time = program.settle + program.dwell * static_cast<double>(stop.samples);
    return std::ceil(time / rules.wait_step - rounding) * rules.wait_step;
}

std::vector<double> waits_of(const ProgramRules& rules, const io::RobotProgram& program,
                             const io::ProgramStop& stop) {
    std::vector<double> waits;
    double rest = dwell_of(rules, program, stop);
    for (; rest > rules.longest_wait; rest -= rules.longest_wait) {
        waits.push_back(rules.longest_wait);
    }
    if (rest > rules.wait_step / 2) waits.push_back(rest);
    return waits;
}

bool TextLine::begins_with(std::string_view word) const {
    return text.size() >= word.size() &&
           std::ranges::equal(text.substr(0, word.size()), word, is_same_letter);
}

bool TextLine::has(std::string_view word) const {
    return std::search(text.begin(), text.end(), word.begin(), word.end(), is_same_letter) !=
           text.end();
}

ProgramFile::ProgramFile(const std::string& path) {
    constexpr std::size_t most_bytes = 1 << 26;
    content_ = read_file(path, most_bytes);
    const std::string_view whole = content_;
    long number = 0;
    for (std::size_t begin = 0; begin < whole.size();) {
        const std::size_t end = std::min(whole.find('\n', begin), whole.size());
        const std::string_view line = whole.substr(begin, end - begin);
        const std::string_view text = trim(line);
        ++number;
        if (!text.empty()) {
            lines_.push_back({text, {path, number, text.data() - line.data() + 1}});
        }
        begin = end + 1;
    }
}

ProgramFile::ProgramFile(const std::string& path, std::string_view end) : ProgramFile(path) {
    const auto ends = [&](const TextLine& line) { return line.begins_with(end); };
    if (std::ranges::any_of(lines_, ends)) return;
    throw input_error_at({path}, fmt::format("has no {}; must be the whole program", end));
}

void check_brackets(const TextLine& statement) {
    std::string open;
    for (const char letter : statement.text) {
        if (letter == '(' || letter == '[' || letter == '{') {
            open += letter == '(' ? ')' : letter == '[' ? ']' : '}';
        } else if (letter == ')' || letter == ']' || letter == '}') {
            if (open.find(letter) == open.npos) {
                throw statement.error(
                    fmt::format("has a {} that nothing opens; must be opened", letter));
            }
            if (letter != open.back()) break;
            open.pop_back();
        }
    }
    if (open.empty()) return;
    throw statement.error(
        fmt::format("has no {} at its end; must have one, in the same line", open.back()));
}

void check_target(const ProgramRules& rules, const TextLine& statement, std::string_view moves) {
    const std::string capitals =
        upper_case(std::string(statement.text.substr(0, statement.text.find('"'))));
    const std::string_view text = capitals;
    const std::size_t found =
        rules.target.empty() ? text.npos : text.find(upper_case(std::string(rules.target)));
    if (found == text.npos || text.find('=') < found) return;
    const std::size_t end = std::min(text.find_first_of("]}", found), text.size());
    const auto commas = std::ranges::count(text.substr(found, end - found), ',');
    if (commas + 1 < rules.target_numbers) return;
    if (is_word(word_before(text, found), moves) || is_word(first_word(text), moves)) return;
    throw statement.error(
        fmt::format("has {} as a move has, but is none that is known; must be put right or removed",
                    quote(rules.target)));
}

void check_percent(const TextLine& line, std::string_view shown, std::string_view number) {
    check_amount(
        line, shown, number, [](double value) { return value > 0 && value <= 100; },
        "be above 0 and at most 100 per cent");
}

void check_speed(const TextLine& line, std::string_view shown, std::string_view number) {
    check_amount(
        line, shown, number, [](double value) { return value > 0; }, "be above 0");
}

void check_time(const TextLine& line, std::string_view shown, std::string_view number) {
    check_amount(
        line, shown, number, [](double value) { return value >= 0; }, "not be below 0");
}

std::string_view first_argument(const TextLine& line, std::string_view call) {
    if (!line.begins_with(call)) return {};
    const std::string_view rest = trim(line.text.substr(call.size()));
    if (!rest.starts_with('(')) return {};
    return trim(rest.substr(1, rest.find_first_of(",)") - 1));
}

std::vector<double> read_numbers(const TextLine& line, std::string_view text) {
    std::vector<double> numbers;
    for (;;) {
        const std::size_t comma = std::min(text.find(','), text.size());
        const std::string_view field = trim(text.substr(0, comma));
        const ParsedNumber number = parse_number(field);
        if (!number.ok()) {
            throw line.error(fmt::format("{} {}", quote(field), number.problem));
        }
        numbers.push_back(number.value);
        if (comma == text.size()) return numbers;
        text.remove_prefix(comma + 1);
    }
}

}  // namespace posewise::detail
