#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace posewise::detail {

/// Looks at a temporary, whole and at this path, and throws unless it may take its place.
using FileCheck = std::function<void(const std::string& temporary)>;

/// Hands over a text that should not all be in memory, part by part.
using TextParts = std::function<void(const std::function<void(std::string_view)>& write)>;

struct FileContent {
    std::string path;
    std::string content;
    FileCheck check = {};
    TextParts more = {};  ///< after the content; if it throws, the file is not written
};

/// Where a file of this path would be written: a link is followed, dangling or not, so that the
/// file it names is replaced, not the link. Throws InputError for a link that leads nowhere.
std::string follow_link(const std::string& path);

/// Writes whole files, all or none: each to a temporary beside it, then all are renamed. A link is
/// followed, a file that is replaced keeps its permissions. Throws InputError if a place cannot be
/// written or, a pipe or a device, not be checked, and what a check throws.
void write_files(const std::vector<FileContent>& files);
void write_file(const std::string& path, const std::string& content, const FileCheck& check = {});

/// The content of a file. Throws InputError if it cannot be read or has more than `most` bytes, of
/// a device more than 1 MiB.
std::string read_file(const std::string& path, std::size_t most = std::size_t{1} << 30);

}  // namespace posewise::detail
