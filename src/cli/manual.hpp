#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace posewise::cli {

/// A section of the manuals in designs/, as it stands there (Markdown).
struct ManualSection {
    std::string topic;  ///< the heading in lower case, "-" for blanks
    std::string_view title;
    std::string_view text;
};
std::vector<ManualSection> manual_sections();

}  // namespace posewise::cli
