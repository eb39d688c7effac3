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

/// The names of `count` parts of a program. Throws InputError if they are longer than the format
/// allows.
std::vector<std::string> part_names(const ProgramRules& rules, const std::string& name,
                                    std::size_t count);

/// The file of the part that the program at `path` calls by this name, beside it; empty if the name
/// is none of a part.
std::string part_path(const std::string& path, std::string_view called);

/// How a format reads a file; a part has no parts of its own.
using ReadModule = std::vector<io::ProgramStop> (*)(const std::string& path,
                                                    const ControllerJoints& joints, bool has_parts);

/// The stops of a part that a line calls. What is wrong in its file is said of that line.
std::vector<io::ProgramStop> read_part(const TextLine& call, const std::string& part,
                                       const ControllerJoints& joints, ReadModule read);

}  // namespace posewise::detail
