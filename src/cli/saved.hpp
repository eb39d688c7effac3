#pragma once

#include <string>
#include <vector>

#include "posewise/io/documents.hpp"

namespace posewise::cli {

/// A file that a command has written, to be shown again.
struct ShownFile {
    std::vector<io::PagePart> parts;  ///< of a store one for each table
    std::string summary;              ///< a line that says what is shown
    std::vector<std::string> read;    ///< other files that were read for it
};

/// What it names and is not there, or is another one now, is left out; a warning says so. Throws
/// InputError for a file that is no plan, estimate or study.
ShownFile show_saved(const std::string& path);

}  // namespace posewise::cli
