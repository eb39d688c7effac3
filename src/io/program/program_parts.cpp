#include "program_parts.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"

namespace posewise::detail {

std::vector<io::RobotProgram> parts_of(
    const io::RobotProgram& program, std::size_t most,
    const std::function<std::size_t(const io::ProgramStop&)>& size_of) {
    io::RobotProgram empty = program;
    empty.stops.clear();
    std::vector<io::RobotProgram> parts{empty};
    std::size_t size = 0;
    for (const io::ProgramStop& stop : program.stops) {
        const std::size_t more = size_of(stop);
        if (size + more > most && size > 0) {
            parts.push_back(empty);
            size = 0;
        }
        parts.back().stops.push_back(stop);
        size += more;
    }
    return parts;
}

std::vector<std::string> part_names(const ProgramRules& rules, const std::string& name,
                                    std::size_t count) {
    std::vector<std::string> names;
    for (std::size_t k = 1; k <= count; ++k) names.push_back(fmt::format("{}_{}", name, k));
    const std::string& longest = names.back();
    if (longest.size() <= rules.longest_name) return names;
    throw InputError(fmt::format(
        "the program is so long that it must be {} programs, whose names, like {}, would "
        "be longer than {} letters; must have a name of at most {}",
        count, longest, rules.longest_name, rules.longest_name - (longest.size() - name.size())));
}

std::string part_path(const std::string& path, std::string_view called) {
    const std::string stem = stem_of(path);
    const bool is_part = called.size() > stem.size() + 1 && called[stem.size()] == '_' &&
                         is_word(called.substr(0, stem.size()), stem) &&
                         called.find_first_not_of("0123456789", stem.size() + 1) == called.npos;
    if (!is_part) return "";
    return sibling_of(path, stem + std::string(called.substr(stem.size())) + ending_of(path));
}

std::vector<io::ProgramStop> read_part(const TextLine& call, const std::string& part,
                                       const ControllerJoints& joints, ReadModule read) {
    try {
        return read(part, joints, false);
    } catch (const InputError& problem) {
        throw call.error(fmt::format("calls a program that cannot be used: {}", problem.what()));
    }
}

}  // namespace posewise::detail
