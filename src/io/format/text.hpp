#pragma once

#include <string>
#include <string_view>

#include "core/text.hpp"

namespace posewise::detail {

/// Without spaces, tabs and carriage returns at both ends.
std::string_view trim(std::string_view text);

/// Where the first byte is that is not of UTF-8 text; npos if all are.
std::size_t find_not_utf8(std::string_view text);

/// "a plan", "an estimate".
std::string with_article(const std::string& noun);

/// Letters, digits and underscores, not starting with a digit.
bool is_identifier(std::string_view text);

/// A number read from text, or what is wrong with it.
struct ParsedNumber {
    double value = 0;
    std::string_view problem;  ///< "is not a number", ...; empty: none

    bool ok() const { return problem.empty(); }
};

/// The whole text as one finite decimal number with a decimal point.
ParsedNumber parse_number(std::string_view text);

}  // namespace posewise::detail
