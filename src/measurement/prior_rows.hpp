#pragma once

#include "posewise/measurement/campaign.hpp"

namespace posewise::detail {

/// A root R (a row for each parameter that has a prior, parameter_count() wide) of
/// prior_information() = R^T R: what is known before measuring as rows of a Jacobian. No rows
/// without a prior. Throws InputError as prior_information().
RowMatrixXd prior_rows(const Campaign& campaign);

}  // namespace posewise::detail
