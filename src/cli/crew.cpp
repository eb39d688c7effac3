#include "crew.hpp"

#include <cstdio>

#include "core/text.hpp"

namespace posewise::cli {

int report(const ProgramEnd& end) {
    if (!end.message.empty()) {
        const std::string line = "posewise: " + detail::escape_controls(end.message) + '\n';
        std::fwrite(line.data(), 1, line.size(), stderr);
    }
    return end.code;
}

}  // namespace posewise::cli
