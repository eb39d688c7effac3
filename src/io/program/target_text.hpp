#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/io/robot_programs.hpp"
#include "program_text.hpp"

/// What readers of the targets of existing programs share.
namespace posewise::detail {

/// The program with blanks in the place of comments and strings.
std::string masked(const std::string& content, char comment);

/// Reads on from a place in a text.
class Cursor {
  public:
    Cursor(std::string_view text, std::size_t at) : text_(text), at_(at) {}

    std::size_t at() const { return at_; }
    bool is_at_end() const { return at_ >= text_.size(); }

    void skip_blanks();
    bool take(char letter);
    std::string_view word();
    std::optional<io::TextSpan> number();
    /// As many numbers, by commas, and the letter after them.
    std::optional<std::vector<io::TextSpan>> numbers(std::size_t count, char close);

  private:
    std::string_view text_;
    std::size_t at_;
};

/// What corrections need to know of a format's programs; nullptr: they are not corrected.
const ProgramKind* target_kind_of(io::ProgramFormat format);

/// Decimals of what replaces the text: as many as it has, at least `least` and at most 12.
int decimals_of(std::string_view text, int least);

/// A number in decimals_of() the text, which it replaces; the text itself where it is the same
/// number then.
std::string number_text(std::string_view text, int least, double number);

// ---- Places: positions that are stated by coordinates ----

/// x, y, z (m) and the orientation of these numbers as the format has them. Throws InputError for a
/// number that no cell has, or a quaternion that is none.
Isometry3d place_of(io::ProgramFormat format, const std::vector<double>& numbers);

/// A place as the format states it, nearest to the numbers that it replaces.
std::vector<double> numbers_of_place(io::ProgramFormat format, const Isometry3d& place,
                                     const std::vector<double>& before);

/// Texts for the spans of a place that was corrected, in their order. Throws InputError, naming the
/// target, where the correction needs another turn than FANUC's configuration has.
std::vector<std::pair<io::TextSpan, std::string>> place_texts(const io::TargetProgram& program,
                                                              std::size_t place,
                                                              io::ProgramFormat format,
                                                              const io::CorrectedPlace& corrected);

/// Throws InputError where moves to places use several tools or frames, or the program shifts them.
/// `text` is the program with blanks in the place of comments and strings, and of all of FANUC's
/// that says nothing of tools and frames.
void check_one_frame(const std::string& path, const std::string& text, io::ProgramFormat format);

/// The tool of the moves to places, where the text states it by numbers.
std::optional<io::StatedTool> stated_tool(const std::string& text, io::ProgramFormat format);

/// Number of a span of the program.
double number_at(const std::string& content, const io::TextSpan& span);

}  // namespace posewise::detail
