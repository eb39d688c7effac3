#pragma once

#include <string>

namespace posewise::detail {

enum class FileKind { Campaign, Document, Table };

/// Throws InputError if the content is plainly another kind of file, as when two arguments are
/// exchanged; the message says what it is and, of a URDF, how a campaign is made from it.
/// `wanted` in words: "a campaign".
void check_file_kind(const std::string& content, const std::string& path, FileKind kind,
                     const std::string& wanted);

}  // namespace posewise::detail
