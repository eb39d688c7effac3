#pragma once

#include <string>
#include <vector>

#include "posewise/model/dh.hpp"

namespace posewise::io {

/// A robot as the section `robot` of a campaign file with a standard Denavit-Hartenberg table, mm
/// and deg with digits enough to read the numbers back. `rows` are those of dh_rows(); names and
/// limits are the chain's joints'. Throws InputError if a joint drives two rows and no row is its
/// own.
std::string make_dh_text(const Chain& chain, const std::vector<DhRow>& rows);

}  // namespace posewise::io
