#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/format/atomic_file.hpp"
#include "io/format/units.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/robot_programs.hpp"

/// What writers and readers of programs share.
namespace posewise::detail {

/// Words that decide whether what follows them is run, and how often; separated by blanks.
struct FlowWords {
    std::string_view routines = "";   ///< begin a routine
    std::string_view opens = "";      ///< begin what may be passed over or repeated
    std::string_view closes = "";     ///< end the last of both
    std::string_view jumps = "";      ///< go on elsewhere, wherever they stand in a statement
    std::string_view leaves = "";     ///< end a routine before its end
    std::string_view modifiers = "";  ///< stand in front of others
    bool has_then = true;             ///< IF without THEN is of one statement
};

/// What a format's files are like.
struct ProgramRules {
    std::string_view ending;  ///< ".ls"; empty: a folder
    int decimals = 0;
    bool is_in_radians = false;    ///< else degrees and mm
    bool has_six_joints = true;    ///< that turn; else any
    bool has_program_name = true;  ///< the file must be called as the program is
    std::size_t longest_name = 32;
    bool has_parts = false;  ///< what is too long is split, see program_parts.hpp
    bool is_upper = false;
    std::string_view words = "";  ///< that name no program, separated by blanks
    bool has_pause = true;
    bool has_io = true;
    double wait_step = 0.001;   ///< of times at which the robot waits, s
    double longest_wait = 1e9;  ///< of one statement, s
    FlowWords flow = {};
    std::string_view waits = "";     ///< begin statements at which the robot waits
    std::string_view messages = "";  ///< begin statements that show the pose's label
    std::string_view moves = "";     ///< begin statements that move, or stand before their target
    /// Words of moves that are not read and of what leads moves elsewhere: a statement has them
    /// nowhere.
    std::string_view others = "";
    /// Begin all statements that do neither, but for calls, assignments and labels. Empty: not
    /// known, so that any word may begin one.
    std::string_view harmless = "";
    std::string_view target = "";  ///< that moves have, and assignments
    Index target_numbers = 0;      ///< that follow it at least
};

struct TextLine;

/// A format, which stands in a file of its own: its rules, its writer and its reader, both of the
/// path as the user states it.
struct ProgramKind {
    ProgramRules rules;
    std::vector<FileContent> (*write)(const std::string& path, const io::RobotProgram& program);
    std::vector<io::ProgramStop> (*read)(const std::string& path, const ControllerJoints& joints);
    /// Throws InputError where a statement of the line is spoilt, in whatever program it is: a slip
    /// in the word of a move, a move that does not end. `read` does so, too; nullptr: it alone.
    void (*check)(const TextLine& line) = nullptr;
    /// Throws InputError where lines contradict each other: a move leads to a position that is not
    /// there. nullptr: nothing to check.
    void (*check_all)(const std::vector<TextLine>& lines) = nullptr;
};

inline constexpr std::size_t longest_label = 16;

std::string lower_case(std::string text);
/// Whether it is one of the words, which blanks separate, whatever their case. A word that ends in
/// * stands for all that begin so.
bool is_word(std::string_view text, std::string_view words);
/// In capitals.
std::string upper_case(std::string text);
/// Letters, digits, underscores and $.
bool is_word_letter(char letter);
/// The word that ends just before a place, blanks between them passed over; empty: none does.
std::string_view word_before(std::string_view text, std::size_t at);
/// The word that begins the text; empty: none does.
std::string_view first_word(std::string_view text);
/// Letters, digits and underscores, the first a letter, none of the words.
std::string legal_name(std::string_view text, std::size_t longest, bool is_upper,
                       std::string_view words);

/// One line of printable ASCII without quotes, backslashes and brackets, for comments.
std::string comment_text(std::string_view text, std::size_t longest = 60);

/// The file's name without folder and ending.
std::string stem_of(const std::string& path);
/// ".src" as it is typed.
std::string ending_of(const std::string& path);
/// The same path with another name and ending in its folder.
std::string sibling_of(const std::string& path, const std::string& name);

/// The file's unit of a joint.
const Unit& unit_of(const ProgramRules& rules, Motion motion);
/// A joint value in the file's unit, with its decimals; never "-0.000".
std::string joint_text(const ProgramRules& rules, Motion motion, double si);
/// All of a stop, separated.
std::string joints_text(const ProgramRules& rules, const ControllerJoints& joints,
                        const VectorXd& values, std::string_view separator);
/// 2.5 as "2.5", 2 as "2.0"; 3 decimals at most.
std::string seconds_text(double seconds);
/// How long the robot waits at a stop, rounded up to steps of the format; 0: not at all.
double dwell_of(const ProgramRules& rules, const io::RobotProgram& program,
                const io::ProgramStop& stop);
/// The same as times of statements one after the other, none over the longest.
std::vector<double> waits_of(const ProgramRules& rules, const io::RobotProgram& program,
                             const io::ProgramStop& stop);

/// Where a text is from, line by line.
struct TextLine {
    std::string_view text;  ///< without blanks around it and carriage return
    FileLocation place;     ///< of its first character

    InputError error(const std::string& problem) const { return input_error_at(place, problem); }
    /// Whether the line begins with these letters, whatever their case.
    bool begins_with(std::string_view word) const;
    /// Whether it has them somewhere.
    bool has(std::string_view word) const;
};

/// A program's file, which is not over 64 MiB.
class ProgramFile {
  public:
    explicit ProgramFile(const std::string& path);
    /// Throws InputError where no line begins with `end`: a part of the file was not copied.
    ProgramFile(const std::string& path, std::string_view end);
    /// In the order of the file; empty ones are left out.
    const std::vector<TextLine>& lines() const { return lines_; }

  private:
    std::string content_;
    std::vector<TextLine> lines_;
};

/// Throws InputError where a bracket of the statement does not close, or was not opened.
void check_brackets(const TextLine& statement);

/// Throws InputError where a statement has a move's target, of joint values, but none of these
/// words (separated by blanks) begins it or stands before the target: a slip in the word.
void check_target(const ProgramRules& rules, const TextLine& statement, std::string_view moves);

/// Throws InputError where a number is stated that is no speed in per cent: 0 or less, or over 100.
/// `shown` is what the statement has there. What is no number (a register, a variable) passes.
void check_percent(const TextLine& line, std::string_view shown, std::string_view number);
/// Likewise where it is no other speed: 0 or less.
void check_speed(const TextLine& line, std::string_view shown, std::string_view number);
/// Likewise where it is no time to wait: below 0.
void check_time(const TextLine& line, std::string_view shown, std::string_view number);
/// What stands between the bracket behind `call` and the next comma or bracket, if the line begins
/// so, "2.0" of "sleep(2.0)"; else empty.
std::string_view first_argument(const TextLine& line, std::string_view call);

/// The finite numbers of `text`, separated by commas. Throws InputError at the line.
std::vector<double> read_numbers(const TextLine& line, std::string_view text);

const ProgramKind& fanuc_program();
const ProgramKind& kuka_program();
const ProgramKind& abb_program();
const ProgramKind& ur_program();
const ProgramKind& yaskawa_program();
const ProgramKind& staubli_program();
const ProgramKind& ros2_program();
const ProgramKind& csv_program();

}  // namespace posewise::detail
