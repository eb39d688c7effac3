#pragma once

#include <string>

namespace posewise::io {

/// Writes a whole file or nothing: to a temporary beside it, then renamed. Throws InputError if
/// the place cannot be written.
void write_file(const std::string& path, const std::string& content);

/// The content of a file. Throws InputError if it cannot be read.
std::string read_file(const std::string& path);

}  // namespace posewise::io
