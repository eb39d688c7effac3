#include "program_stops.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "io/format/text.hpp"
#include "io/format/units.hpp"

namespace posewise::detail {
namespace {

/// The words of a statement in order, without those between quotes.
std::vector<std::string_view> words_of_statement(std::string_view text) {
    std::vector<std::string_view> words;
    for (std::size_t k = 0; k < text.size();) {
        if (text[k] == '"') {
            k = std::min(text.find('"', k + 1), text.size() - 1) + 1;
        } else if (is_word_letter(text[k])) {
            std::size_t end = k;
            while (end < text.size() && is_word_letter(text[end])) ++end;
            words.push_back(text.substr(k, end - k));
            k = end;
        } else {
            ++k;
        }
    }
    return words;
}

bool could_be_label(std::string_view word) {
    return !word.empty() && word.size() <= longest_label && is_identifier('_' + std::string(word));
}

}  // namespace

void StopCollector::note(std::string_view comment) {
    const std::string_view word = trim(comment);
    if (could_be_label(word)) comment_ = word;
}

void StopCollector::move(const TextLine& line, const std::vector<double>& numbers) {
    check_move(line);
    if (std::ssize(numbers) != joints_.count()) {
        throw line.error(fmt::format("moves {} joints; must be {}, as the robot has",
                                     numbers.size(), joints_.count()));
    }
    io::ProgramStop stop;
    stop.label = comment_;
    stop.place = line.place;
    stop.joints.resize(joints_.count());
    for (Index i = 0; i < joints_.count(); ++i) {
        const double value = numbers[static_cast<std::size_t>(i)];
        const double si = unit_of(rules_, joints_.motion(i)).to_si(value);
        if (!is_plausible(si, quantity_of(joints_.motion(i)))) {
            throw line.error(
                fmt::format("has {} for joint {}, which no robot reaches", value, i + 1));
        }
        stop.joints[i] = si;
    }
    for (const char* const passed : {"home", "via"}) {
        if (is_word(stop.label, passed)) stop.label = passed;
    }
    stop.is_measured = !stop.label.empty() && stop.label != "home" && stop.label != "via";
    comment_.clear();
    stops_.push_back(stop);
    messages_.emplace_back();
}

void StopCollector::call(const TextLine& line, const std::vector<io::ProgramStop>& stops) {
    check_move(line);
    stops_.insert(stops_.end(), stops.begin(), stops.end());
    messages_.resize(stops_.size());
    comment_.clear();
}

void StopCollector::check_move(const TextLine& line) {
    for (const Opened& opened : opened_) {
        if (opened.is_routine) continue;
        throw line.error(fmt::format(
            "moves within {} of line {}, which may pass it over or repeat it; must "
            "stand outside",
            quote(words_of_statement(opened.line.text).front()), opened.line.place.line));
    }
    if (left_) {
        throw line.error(fmt::format(
            "moves after line {}, {}, which leaves the routine; one of them must be removed",
            left_->place.line, quote(left_->text)));
    }
    if (!moving_) moving_ = routine_;
    if (*moving_ == routine_) return;
    throw line.error(fmt::format(
        "moves in another routine than the moves before it; must be in that of line {}, since "
        "their order is not seen otherwise",
        *moving_));
}

void StopCollector::pass(const TextLine& statement) {
    check_flow(statement);
    check_target(rules_, statement, "");  // moves do not come here
    check_others(statement);
    const std::vector<std::string_view> words = words_of_statement(statement.text);
    if (words.empty()) return;
    if (is_word(words.front(), rules_.waits)) wait();
    if (is_word(words.front(), rules_.messages)) name_by_message(statement);
}

void StopCollector::check_others(const TextLine& statement) {
    const std::vector<std::string_view> words = words_of_statement(statement.text);
    if (words.empty()) return;
    const FlowWords& flow = rules_.flow;
    const bool is_modified = is_word(words.front(), flow.modifiers) && words.size() > 1;
    if (is_word(words[is_modified ? 1 : 0], flow.routines)) return;
    for (const std::string_view word : words) {
        if (!is_word(word, rules_.others)) continue;
        throw statement.error(fmt::format(
            "has {}, which moves the robot otherwise or leads moves elsewhere; must be removed",
            quote(word)));
    }
    if (rules_.harmless.empty() || is_harmless(statement)) return;
    throw statement.error(
        fmt::format("has {}, which is not known and may move the robot; must be put right or "
                    "removed",
                    quote(words.front())));
}

/// Calls, assignments and labels are: what calls do is not looked at.
bool StopCollector::is_harmless(const TextLine& statement) const {
    const std::string_view word = first_word(statement.text);
    if (word.empty() || is_word(word, rules_.harmless)) return true;
    const std::string_view rest = trim(statement.text.substr(word.size()));
    return !rest.empty() && std::string_view("=([.:").find(rest.front()) != std::string_view::npos;
}

void StopCollector::wait() {
    if (stops_.empty() || !stops_.back().label.empty()) return;
    stops_.back().is_measured = true;
}

void StopCollector::check_flow(const TextLine& statement) {
    const FlowWords& flow = rules_.flow;
    std::vector<std::string_view> words = words_of_statement(statement.text);
    const auto has = [&](std::string_view some) {
        return std::ranges::any_of(words, [&](std::string_view one) { return is_word(one, some); });
    };
    if (has(flow.jumps)) {
        throw statement.error(
            "jumps, so that moves may be passed over or repeated; must be removed, a program is "
            "read from top to bottom");
    }
    std::size_t first = 0;
    while (first < words.size() && is_word(words[first], flow.modifiers)) ++first;
    if (first == words.size()) return;
    const bool is_condition = is_word(words[first], "IF");
    const bool opens =
        is_word(words[first], flow.opens) && (!is_condition || !flow.has_then || has("THEN"));
    if (is_word(words[first], flow.leaves) || (is_condition && !opens && has(flow.leaves))) {
        left_ = statement;
    }
    if (opens || is_word(words[first], flow.routines)) open(statement, !opens);
    if (is_word(words[first], flow.closes)) close();
}

void StopCollector::open(const TextLine& statement, bool is_routine) {
    opened_.push_back({statement, is_routine});
    if (!is_routine) return;
    routine_ = statement.place.line;
    left_.reset();
}

void StopCollector::close() {
    if (opened_.empty()) return;
    const bool is_routine = opened_.back().is_routine;
    opened_.pop_back();
    if (!is_routine) return;
    left_.reset();
    routine_ = 0;
    for (const Opened& outer : opened_) {
        if (outer.is_routine) routine_ = outer.line.place.line;
    }
}

void StopCollector::name_by_message(const TextLine& statement) {
    if (stops_.empty()) return;
    const std::size_t begin = statement.text.find('"');
    const std::size_t end =
        statement.text.find('"', std::min(begin, statement.text.size() - 1) + 1);
    if (end == std::string_view::npos) return;
    const std::string_view message = trim(statement.text.substr(begin + 1, end - begin - 1));
    if (could_be_label(message)) messages_.back() = message;
}

std::vector<io::ProgramStop> StopCollector::finish() {
    if (!opened_.empty()) {
        throw opened_.back().line.error("does not end; must be the whole program");
    }
    for (std::size_t k = 0; k < stops_.size(); ++k) {
        io::ProgramStop& stop = stops_[k];
        if (stop.label.empty() && stop.is_measured) stop.label = messages_[k];
    }
    return stops_;
}

}  // namespace posewise::detail
