#pragma once

#include <algorithm>
#include <string>

#include "posewise/core/random.hpp"

namespace posewise::testing {

/// A file as it may come: one to three times a byte replaced, up to 30 bytes cut out or doubled.
inline std::string mutate_bytes(std::string content, RandomStream& stream) {
    const std::string bytes = "<>/=\"'&;! -.09exyz{}[]:,#\n\t\x01\xff";
    const auto below = [&](std::size_t count) {
        return static_cast<std::size_t>(stream.index(static_cast<Index>(count)));
    };
    for (std::size_t edits = 1 + below(3); edits > 0 && !content.empty(); --edits) {
        const std::size_t position = below(content.size());
        const std::size_t length = std::min(below(30), content.size() - position);
        switch (below(3)) {
            case 0:
                content[position] = bytes[below(bytes.size())];
                break;
            case 1:
                content.erase(position, length);
                break;
            default:
                content.insert(position, content.substr(below(content.size()), length));
        }
    }
    return content;
}

}  // namespace posewise::testing
