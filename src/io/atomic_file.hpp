#pragma once

#include <cstddef>
#include <string>

namespace posewise::detail {

/// Writes a whole file or nothing: to a temporary beside it, then renamed. A link is
/// followed. Throws InputError if the place cannot be written.
void write_file(const std::string& path, const std::string& content);

/// The content of a file. Throws InputError if it cannot be read or has more than `most` bytes.
std::string read_file(const std::string& path, std::size_t most = std::size_t{1} << 30);

}  // namespace posewise::detail
