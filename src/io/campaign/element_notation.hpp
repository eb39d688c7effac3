#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// Reads a robot's elements, one line of text each, in order (notation: see read_campaign()).
class ElementParser {
  public:
    /// `joint_names` in the order of the robot's joints. `shown_names`: those of the controller's
    /// joints where a name may be meant as one of them, for messages.
    explicit ElementParser(std::vector<std::string> joint_names,
                           std::vector<std::string> shown_names = {});

    /// The element in `text`, whose first character stands at `start`. Throws InputError that
    /// points at the character where the notation, a unit, a joint or a name goes wrong.
    Element parse(std::string_view text, const FileLocation& start);

    /// The sum of joints in `text` that drives an element of that motion: `q3`, `-q3 + 0.5*q2`.
    /// Throws InputError as parse() does, and if there is an amount among them.
    std::vector<JointTerm> parse_drive(std::string_view text, const FileLocation& start,
                                       Motion motion);

    /// A sum of joints and amounts, `q3 - q2 + 90 deg`, of that motion. Throws InputError as
    /// parse() does, and if there is no joint in it.
    Element parse_joint_sum(std::string_view text, const FileLocation& start, Motion motion) const;

    /// What a joint drives in the elements so far; nothing if none.
    std::optional<Motion> joint_motion(Index joint) const {
        return driven_[static_cast<std::size_t>(joint)];
    }

  private:
    class Cursor;
    struct Sum;

    void parse_sum(Cursor& cursor, Sum& sum) const;
    void parse_term(Cursor& cursor, double sign, Sum& sum) const;
    void add_nominal(Cursor& cursor, double number, std::size_t start, Sum& sum) const;
    void add_joint(Cursor& cursor, double coefficient, Sum& sum) const;
    void parse_error(Cursor& cursor, Element& element);
    std::string parse_parameter(Cursor& cursor);
    JointFunction parse_function(Cursor& cursor) const;
    void note_driven(const Element& element);

    std::string describe_unknown_joint(const std::string& name) const;

    std::vector<std::string> joint_names_;
    std::vector<std::string> shown_names_;
    std::vector<std::optional<Motion>> driven_;
    std::map<std::string, long> parameter_lines_;
};

}  // namespace posewise::detail
