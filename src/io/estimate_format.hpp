#pragma once

/// What writer and readers of estimate files share.
namespace posewise::detail {

inline constexpr int estimate_format = 1;

}  // namespace posewise::detail
