#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "program_text.hpp"

namespace posewise::detail {

/// The stops of a program, collected as its statements are read from top to bottom. Readers refuse
/// what would let the robot visit other stops, or these in another order: jumps, and moves within
/// conditions, loops and second routines.
class StopCollector {
  public:
    StopCollector(const ProgramRules& rules, const ControllerJoints& joints)
        : rules_(rules), joints_(joints) {}

    /// A comment names the next move if it could be a pose's label, home or via; else it says
    /// something to people, and what stood before holds.
    void note(std::string_view comment);
    /// The next move's name, where a format has a place for it.
    void name(std::string_view label) { comment_ = label; }
    /// A move to joints in the file's unit. Throws InputError at the line for another number of
    /// joints, and where it may be passed over or repeated.
    void move(const TextLine& line, const std::vector<double>& numbers);
    /// A call of a program with these stops; likewise.
    void call(const TextLine& line, const std::vector<io::ProgramStop>& stops);
    /// Any other statement. Throws InputError at the line if it jumps, has a move's target, or is
    /// none of those that are known not to move the robot otherwise.
    void pass(const TextLine& statement);
    /// The robot waits at the last stop.
    void wait();
    /// Throws InputError where a routine, condition or loop does not end.
    std::vector<io::ProgramStop> finish();

  private:
    struct Opened {
        TextLine line;
        bool is_routine = false;
    };

    void check_move(const TextLine& line);
    void check_flow(const TextLine& statement);
    void check_others(const TextLine& statement);
    bool is_harmless(const TextLine& statement) const;
    void open(const TextLine& statement, bool is_routine);
    void close();
    void name_by_message(const TextLine& statement);

    const ProgramRules& rules_;
    const ControllerJoints& joints_;
    std::string comment_;
    std::vector<Opened> opened_;
    long routine_ = 0;              // the line where it begins; 0: there are none
    std::optional<long> moving_;    // the routine of the moves
    std::optional<TextLine> left_;  // what ends the routine before its end
    std::vector<io::ProgramStop> stops_;
    std::vector<std::string> messages_;  // that are shown at each stop
};

}  // namespace posewise::detail
