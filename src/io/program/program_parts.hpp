#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "program_text.hpp"

/// Programs that are too long for a controller: one that calls others, NAME_1, NAME_2, ...
namespace posewise::detail {

/// The program in as many as its stops need, in order, none of which has over `most` of what
/// `size_of` counts for a stop.
std::vector<io::RobotProgram> parts_of(
    const io::RobotProgram& program, std::size_t most,
    const std::function<std::size_t(const io::ProgramStop&)>& size_of);

/// The names of so many parts of a program. Throws InputError if they are longer than the format's
/// may be.
std::vector<std::string> part_names(const ProgramRules& rules, const std::string& name,
                                    std::size_t count);

/// The file of the part that is called so, beside the program at `path`; empty: it is no part of
/// it.
std::string part_path(const std::string& path, std::string_view called);

/// The stops of a part, which `read` reads from its file; what is wrong there is said of the call.
std::vector<io::ProgramStop> read_part(
    const TextLine& call, const std::string& part,
    const std::function<std::vector<io::ProgramStop>(const std::string& path)>& read);

}  // namespace posewise::detail
