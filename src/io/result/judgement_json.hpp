#pragma once

#include "io/format/json.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise::detail {

Json metrics_to_json(const Metrics& metrics);

/// What is covered of each image, a list.
Json images_to_json(const std::vector<ImageCoverage>& images);

/// What a calibration does at poses that it was not made with: metrics of `verification`,
/// `left_out` and `validation`, and `judged`, a list of their groups.
void add_judgements(Json& accuracy, const Calibration& calibration);

}  // namespace posewise::detail
