#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/types.hpp"

/// Words of messages.
namespace posewise::detail {

/// Text with every control character (C0, C1, those of writing direction) and whatever is not UTF-8
/// as \xNN, so that it stays one line and harms no terminal.
std::string escape_controls(std::string_view text);

/// What a user wrote, for a message: in quotes, controls escaped, cut after about 60 bytes (at
/// the end of a UTF-8 character).
std::string quote(std::string_view text);

/// Length in bytes of the UTF-8 character at the beginning of a text that is not empty; 1 for what
/// is not UTF-8.
std::size_t character_length(std::string_view text);

/// "1 pose", "2 poses"; the plural is the noun with an s.
std::string count_of(Index count, const std::string& noun);
/// "this pose", "these 2 poses".
std::string these(Index count, const std::string& noun);

/// "a, b or c".
std::string list_words(const std::vector<std::string>& words);

/// "0.71 base.x - 0.7 Tx1": the largest terms of a linear combination, four at most, the largest
/// first and positive, with the direction's norm 1. Without names: "0.71 column 2 - 0.7 column 5".
std::string describe_combination(const VectorXd& coefficients,
                                 const std::vector<std::string>& names);

/// The text in lines of at most `width` characters, as far as its words allow.
std::vector<std::string> wrap(const std::string& text, std::size_t width);

/// The advice after an unknown name: "did you mean 'x'?" if one of the known is near, else
/// "must be a, b or c".
std::string suggest(std::string_view unknown, const std::vector<std::string>& known);

}  // namespace posewise::detail
