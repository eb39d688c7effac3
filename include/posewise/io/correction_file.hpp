#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/correction.hpp"

namespace posewise::io {

/// Writes CSV: config, the corrected joint values (degrees or mm, digits enough to read them back
/// exactly), residual_mm, residual_mrad, uncorrected_mm, uncorrected_mrad, and note
/// (describe_shortfall()); purpose, too, if `purposes` are stated. These, `ids` and `corrections`
/// are of equal length.
void write_corrections_csv(const std::string& path, const Campaign& campaign,
                           const std::vector<std::string>& ids,
                           const std::vector<Correction>& corrections,
                           const std::vector<std::string>& purposes = {});

}  // namespace posewise::io
