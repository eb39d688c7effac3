#include "element_notation.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>

#include "io/format/text.hpp"
#include "io/format/units.hpp"

namespace posewise::detail {

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

    /// The name of a function in front of its '('; goes to that.
    bool accept_function(std::string_view name) {
        skip_blanks();
        const std::size_t start = position_;
        if (read_word() == name && peek() == '(') return true;
        position_ = start;
        return false;
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

/// Amounts and joints added up: what drives an element, or u of a JointFunction.
struct ElementParser::Sum {
    Motion motion;        ///< of the amounts
    std::string subject;  ///< "Tx is a translation"
    bool drives = true;   ///< joints move by it
    double value = 0;
    std::vector<JointTerm> joints = {};
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

ElementParser::ElementParser(std::vector<std::string> joint_names,
                             std::vector<std::string> shown_names)
    : joint_names_(std::move(joint_names)),
      shown_names_(std::move(shown_names)),
      driven_(joint_names_.size()) {}

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
    Sum sum{element.motion, describe(element)};
    parse_sum(cursor, sum);
    element.value = sum.value;
    element.joints = std::move(sum.joints);
    while (cursor.peek() == '[') parse_error(cursor, element);
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
    Sum sum{motion, describe(element)};
    parse_sum(cursor, sum);
    element.joints = std::move(sum.joints);
    if (cursor.peek() != '\0' || sum.value != 0 || element.joints.empty()) {
        throw cursor.error(first,
                           quote(text) + " is no sum of joints; must be like '-q3 + 0.5*q2'");
    }
    note_driven(element);
    return std::move(element.joints);
}

Element ElementParser::parse_joint_sum(std::string_view text, const FileLocation& start,
                                       Motion motion) const {
    Cursor cursor(text, start);
    cursor.skip_blanks();
    const std::size_t first = cursor.position();
    Sum sum{motion, motion == Motion::Rotation ? "the joint turns" : "the joint slides"};
    parse_sum(cursor, sum);
    if (cursor.peek() != '\0') {
        throw cursor.error(cursor.position(), quote(cursor.character()) +
                                                  " is not expected here; must be a sum of joints "
                                                  "like 'q3 - q2 + 90 deg'");
    }
    if (sum.joints.empty()) {
        throw cursor.error(first, quote(text) + " has no joint; must be a sum like 'q3 - q2'");
    }
    Element element;
    element.motion = motion;
    element.value = sum.value;
    element.joints = std::move(sum.joints);
    return element;
}

void ElementParser::note_driven(const Element& element) {
    for (const JointTerm& term : element.joints) {
        driven_[static_cast<std::size_t>(term.joint)] = element.motion;
    }
}

void ElementParser::parse_sum(Cursor& cursor, Sum& sum) const {
    double sign = cursor.accept('-') ? -1 : 1;
    if (sign > 0) cursor.accept('+');
    for (;;) {
        parse_term(cursor, sign, sum);
        if (cursor.accept('+')) {
            sign = 1;
        } else if (cursor.accept('-')) {
            sign = -1;
        } else {
            return;
        }
    }
}

void ElementParser::parse_term(Cursor& cursor, double sign, Sum& sum) const {
    const char next = cursor.peek();
    if (is_identifier(std::string(1, next))) {
        add_joint(cursor, sign, sum);
        return;
    }
    const std::size_t start = cursor.position();
    if (next != '.' && (next < '0' || next > '9')) {
        throw cursor.error(start, std::string("an amount or a joint is missing; ") + example);
    }
    const double number = sign * cursor.read_number();
    if (!cursor.accept('*')) {
        add_nominal(cursor, number, start, sum);
    } else if (number == 0) {
        throw cursor.error(start, "a joint's coefficient is 0; must not be, leave the joint out");
    } else if (!(std::abs(number) >= 1e-6 && std::abs(number) <= 1e6)) {
        throw cursor.error(start, "a joint's coefficient must be from 1e-6 to 1e6 in magnitude");
    } else {
        add_joint(cursor, number, sum);
    }
}

void ElementParser::add_nominal(Cursor& cursor, double number, std::size_t start, Sum& sum) const {
    const Quantity quantity = quantity_of(sum.motion);
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
        throw cursor.error(unit_position, sum.subject + ", its amount cannot be in " + quote(name) +
                                              "; must be in " + units);
    }
    sum.value += unit->to_si(number);
    if (!is_plausible(sum.value, quantity)) {
        throw cursor.error(start, "the amount is too large; must be " + plausible(*unit));
    }
}

/// Robot's and controller's joints are named alike: none is guessed, but for capitals.
std::string ElementParser::describe_unknown_joint(const std::string& name) const {
    if (shown_names_.empty()) return " is no joint of the robot; " + suggest(name, joint_names_);
    if (std::ranges::find(shown_names_, name) != shown_names_.end()) {
        return " is a joint of the controller; must stand alone, or the sum must be of the robot's "
               "joints: " +
               list_words(joint_names_);
    }
    std::vector<std::string> known = shown_names_;
    known.insert(known.end(), joint_names_.begin(), joint_names_.end());
    const auto upper = [](unsigned char letter) { return std::toupper(letter); };
    const auto alike = std::ranges::find_if(known, [&](const std::string& one) {
        return std::ranges::equal(one, name, {}, upper, upper);
    });
    return " is no joint of the robot or of its controller; " +
           (alike != known.end() ? "did you mean " + quote(*alike) + "?"
                                 : "must be " + list_words(known));
}

void ElementParser::add_joint(Cursor& cursor, double coefficient, Sum& sum) const {
    cursor.skip_blanks();
    const std::size_t position = cursor.position();
    const std::string name = cursor.read_word();
    const auto found = std::find(joint_names_.begin(), joint_names_.end(), name);
    if (found == joint_names_.end()) {
        throw cursor.error(position, quote(name) + describe_unknown_joint(name));
    }
    const Index joint = found - joint_names_.begin();
    const auto same = [joint](const JointTerm& term) { return term.joint == joint; };
    if (std::any_of(sum.joints.begin(), sum.joints.end(), same)) {
        throw cursor.error(position, "joint " + quote(name) +
                                         " occurs twice in one element; write it "
                                         "once with a coefficient, like 2*" +
                                         name);
    }
    const auto driven = joint_motion(joint);
    if (sum.drives && driven && *driven != sum.motion) {
        throw cursor.error(position, sum.subject + " but joint " + quote(name) +
                                         " drives the other kind before; must drive one kind, "
                                         "since its unit is either rad or m");
    }
    sum.joints.push_back({joint, coefficient});
}

/// One bracket: `[name]`, or `[name * f]` with f a JointFunction.
void ElementParser::parse_error(Cursor& cursor, Element& element) {
    cursor.accept('[');
    cursor.skip_blanks();
    const std::size_t position = cursor.position();
    const std::string name = parse_parameter(cursor);
    if (cursor.accept('*')) {
        element.terms.push_back({name, parse_function(cursor)});
    } else if (element.parameter.empty()) {
        element.parameter = name;
    } else {
        throw cursor.error(position, "parameter " + quote(name) +
                                         " is a second constant error of the element, beside " +
                                         quote(element.parameter) +
                                         "; must be one, or depend on joints like [" + name +
                                         "*sin(" + joint_names_.front() + ")]");
    }
    if (!cursor.accept(']')) {
        throw cursor.error(cursor.position(), "a ']' must stand behind parameter " + quote(name));
    }
}

std::string ElementParser::parse_parameter(Cursor& cursor) {
    const std::size_t position = cursor.position();
    const std::string name = cursor.read_word();
    if (!is_identifier(name)) {
        throw cursor.error(position,
                           "the brackets must hold the name of one error parameter: "
                           "letters, digits and underscores, like [Tx1]");
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
    return name;
}

/// `sin(sum)`, `cos(sum)`, `(sum of joints)` or one joint.
JointFunction ElementParser::parse_function(Cursor& cursor) const {
    cursor.skip_blanks();
    const std::size_t position = cursor.position();
    Sum sum{Motion::Rotation, "the argument of a sine is an angle", false};
    JointFunction function;
    const bool is_cosine = cursor.accept_function("cos");
    if (is_cosine || cursor.accept_function("sin")) function.shape = JointFunction::Shape::Sine;
    if (cursor.accept('(')) {
        parse_sum(cursor, sum);
        if (!cursor.accept(')')) throw cursor.error(cursor.position(), "a ')' is missing here");
    } else {
        parse_term(cursor, cursor.accept('-') ? -1 : 1, sum);
    }
    const bool is_sine = function.shape == JointFunction::Shape::Sine;
    if (sum.joints.empty() || (!is_sine && sum.value != 0)) {
        throw cursor.error(position,
                           "an error's function must depend on joints, like sin(q2 + 30 "
                           "deg), cos(2*q2), q3 or (q3 - 0.5*q2)");
    }
    function.joints = std::move(sum.joints);
    function.phase = sum.value + (is_cosine ? std::numbers::pi / 2 : 0);
    return function;
}

}  // namespace posewise::detail
