#pragma once

#include <string_view>

namespace posewise::detail {

/// The page as src/page/page.html has it, part of the program: where its document belongs there is
/// an empty one.
std::string_view page_template();

}  // namespace posewise::detail
