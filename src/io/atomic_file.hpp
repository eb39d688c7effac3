#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace posewise::detail {

/// Writes a whole file or nothing: to a temporary beside it, then renamed. A link is
/// followed. Throws InputError if the place cannot be written.
void write_file(const std::string& path, const std::string& content);

/// The same if the temporary, whole and at the path that `check` is given, passes: what `check`
/// throws is thrown, and nothing is written. Throws InputError for a pipe or a device.
void write_file(const std::string& path, const std::string& content,
                const std::function<void(const std::string& temporary)>& check);

/// The content of a file. Throws InputError if it cannot be read or has more than `most` bytes.
std::string read_file(const std::string& path, std::size_t most = std::size_t{1} << 30);

}  // namespace posewise::detail
