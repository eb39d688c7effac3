#include "element_notation.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "text.hpp"
#include "units.hpp"

namespace posewise::io {

/// A place in the text of one element.
class ElementParser::Cursor {
  public:
    Cursor(std::string_view text, const FileLocation& start) : text_(text), start_(start) {}

    std::size_t position() const { return position_; }
    long line() const { return start_.line; }

    InputError error(std::size_t position, const std::string& message) const {
        FileLocation location = start_;
        location.column += static_cast<long>(position);
        return input_error_at(location, message);
    }

    void skip_blanks() {
        while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t')) {
            ++position_;
        }
    }

    /// The next character that is not blank; 0 at the end.
    char peek() {
        skip_blanks();
        return position_ < text_.size() ? text_[position_] : '\0';
    }

    /// The whole UTF-8 character at the position, which is not the end.
    std::string_view character() const {
        const std::string_view rest = text_.substr(position_);
        return rest.substr(0, character_length(rest));
    }

    bool accept(char wanted) {
        if (peek() != wanted) return false;
        ++position_;
        return true;
    }

    /// Letters, digits and underscores from here; empty if there are none.
    std::string read_word() {
        skip_blanks();
        std::size_t end = position_;
        while (end < text_.size() && is_identifier('_' + std::string(1, text_[end]))) ++end;
        const std::string word(text_.substr(position_, end - position_));
        position_ = end;
        return word;
    }

    double read_number() {
        double number = 0;
        const char* const first = text_.data() + position_;
        const auto [end, problem] = std::from_chars(first, text_.data() + text_.size(), number);
        if (problem == std::errc::invalid_argument) throw error(position_, "not a number");
        if (problem != std::errc()) throw error(position_, "number beyond the range of numbers");
        position_ += static_cast<std::size_t>(end - first);
        return number;
    }

  private:
    std::string_view text_;
    FileLocation start_;
    std::size_t position_ = 0;
};

namespace {

constexpr const char* example = "must be like 'Tx 312 mm [Tx1]' or 'Ry -q2 + 0.5 deg [dq2]'";

/// "Tx is a translation".
std::string describe(const Element& element) {
    const bool turns = element.motion == Motion::Rotation;
    return std::string(turns ? "R" : "T") +
           static_cast<char>('x' + static_cast<int>(element.axis)) +
           (turns ? " is a rotation" : " is a translation");
}

bool is_kind(const std::string& word) {
    return word.size() == 2 && (word[0] == 'T' || word[0] == 'R') && word[1] >= 'x' &&
           word[1] <= 'z';
}

}  // namespace

ElementParser::ElementParser(std::vector<std::string> joint_names)
    : joint_names_(std::move(joint_names)), driven_(joint_names_.size()) {}

Element ElementParser::parse(std::string_view text, const FileLocation& start) {
    Cursor cursor(text, start);
    cursor.skip_blanks();
    const std::size_t kind_position = cursor.position();
    const std::string kind = cursor.read_word();
    if (!is_kind(kind)) {
        throw cursor.error(kind_position, "an element begins with Tx, Ty, Tz, Rx, Ry or Rz, not " +
                                              quote(kind) + "; " + example);
    }
    Element element;
    element.motion = kind[0] == 'R' ? Motion::Rotation : Motion::Translation;
    element.axis = static_cast<Axis>(kind[1] - 'x');
    parse_sum(cursor, element);
    if (cursor.peek() == '[') parse_parameter(cursor, element);
    if (cursor.peek() != '\0') {
        throw cursor.error(cursor.position(), quote(cursor.character()) +
                                                  " is not expected here; an element " + example);
    }
    note_driven(element);
    return element;
}

std::vector<JointTerm> ElementParser::parse_drive(std::string_view text, const FileLocation& start,
                                                  Motion motion) {
    Cursor cursor(text, start);
    Element element;
    element.motion = motion;
    element.axis = Axis::Z;
    cursor.skip_blanks();
    const std::size_t first = cursor.position();
    parse_sum(cursor, element);
    if (cursor.peek() != '\0' || element.value != 0 || element.joints.empty()) {
        throw cursor.error(first,
                           quote(text) + " is no sum of joints; must be like '-q3 + 0.5*q2'");
    }
    note_driven(element);
    return std::move(element.joints);
}

void ElementParser::note_driven(const Element& element) {
    for (const JointTerm& term : element.joints) {
        driven_[static_cast<std::size_t>(term.joint)] = element.motion;
    }
}

void ElementParser::parse_sum(Cursor& cursor, Element& element) const {
    double sign = cursor.accept('-') ? -1 : 1;
    if (sign > 0) cursor.accept('+');
    for (;;) {
        parse_term(cursor, sign, element);
        if (cursor.accept('+')) {
            sign = 1;
        } else if (cursor.accept('-')) {
            sign = -1;
        } else {
            return;
        }
    }
}

void ElementParser::parse_term(Cursor& cursor, double sign, Element& element) const {
    const char next = cursor.peek();
    if (is_identifier(std::string(1, next))) {
        add_joint(cursor, sign, element);
        return;
    }
    const std::size_t start = cursor.position();
    if (next != '.' && (next < '0' || next > '9')) {
        throw cursor.error(start, std::string("an amount or a joint is missing; ") + example);
    }
    const double number = sign * cursor.read_number();
    if (!cursor.accept('*')) {
        add_nominal(cursor, number, start, element);
    } else if (number == 0) {
        throw cursor.error(start, "a joint's coefficient is 0; must not be, leave the joint out");
    } else if (!(std::abs(number) >= 1e-6 && std::abs(number) <= 1e6)) {
        throw cursor.error(start, "a joint's coefficient must be from 1e-6 to 1e6 in magnitude");
    } else {
        add_joint(cursor, number, element);
    }
}

void ElementParser::add_nominal(Cursor& cursor, double number, std::size_t start,
                                Element& element) const {
    const Quantity quantity = quantity_of(element.motion);
    const std::string units = list_words(unit_names(quantity));
    cursor.skip_blanks();
    const std::size_t unit_position = cursor.position();
    const std::string name = cursor.read_word();
    if (name.empty()) {
        if (number == 0) return;  // zero of any unit
        throw cursor.error(start, "a number without unit; must be in " + units);
    }
    const Unit* const unit = find_unit(name);
    if (std::find(joint_names_.begin(), joint_names_.end(), name) != joint_names_.end()) {
        throw cursor.error(unit_position, "a '*' is missing before joint " + quote(name) +
                                              "; must be like -1.5*" + name);
    }
    if (unit == nullptr || unit->quantity != quantity) {
        throw cursor.error(unit_position, describe(element) + ", its amount cannot be in " +
                                              quote(name) + "; must be in " + units);
    }
    element.value += unit->to_si(number);
    if (!is_plausible(element.value, quantity)) {
        throw cursor.error(start, "the amount is too large; must be " + plausible(quantity));
    }
}

void ElementParser::add_joint(Cursor& cursor, double coefficient, Element& element) const {
    cursor.skip_blanks();
    const std::size_t position = cursor.position();
    const std::string name = cursor.read_word();
    const auto found = std::find(joint_names_.begin(), joint_names_.end(), name);
    if (found == joint_names_.end()) {
        throw cursor.error(
            position, quote(name) + " is no joint of the robot; " + suggest(name, joint_names_));
    }
    const Index joint = found - joint_names_.begin();
    const auto same = [joint](const JointTerm& term) { return term.joint == joint; };
    if (std::any_of(element.joints.begin(), element.joints.end(), same)) {
        throw cursor.error(position, "joint " + quote(name) +
                                         " occurs twice in one element; write it "
                                         "once with a coefficient, like 2*" +
                                         name);
    }
    const auto driven = joint_motion(joint);
    if (driven && *driven != element.motion) {
        throw cursor.error(position, describe(element) + " but joint " + quote(name) +
                                         " drives the other kind before; must drive one kind, "
                                         "since its unit is either rad or m");
    }
    element.joints.push_back({joint, coefficient});
}

void ElementParser::parse_parameter(Cursor& cursor, Element& element) {
    cursor.accept('[');
    cursor.skip_blanks();
    const std::size_t position = cursor.position();
    const std::string name = cursor.read_word();
    if (!is_identifier(name)) {
        throw cursor.error(position,
                           "the brackets must hold the name of one error parameter: "
                           "letters, digits and underscores, like [Tx1]");
    }
    if (!cursor.accept(']')) {
        throw cursor.error(cursor.position(), "a ']' must stand behind parameter " + quote(name));
    }
    if (std::find(joint_names_.begin(), joint_names_.end(), name) != joint_names_.end()) {
        throw cursor.error(position, "parameter " + quote(name) +
                                         " has the name of a joint; must have "
                                         "one of its own, like d" +
                                         name);
    }
    const auto [first, is_new] = parameter_lines_.emplace(name, cursor.line());
    if (!is_new) {
        throw cursor.error(position, "parameter " + quote(name) + " occurs twice, first in line " +
                                         std::to_string(first->second) +
                                         "; must have a name of its own");
    }
    element.parameter = name;
}

}  // namespace posewise::io
