#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/format/json.hpp"
#include "posewise/task/blocks_study.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/study.hpp"

/// The keywords of calls from Python, as a JSON object of those that were stated. Each has its
/// range here, the same that files and the command line have. All throw InputError, with the
/// keyword, for a value of another kind or out of range.
namespace posewise::python {

/// What was stated in the call of a function.
struct Keywords {
    std::string function;  ///< for messages: "select"
    detail::Json stated;
};
Keywords parse_keywords(const std::string& function, const std::string& json);

PlanRequest choice_request(const Keywords& keywords);
PlanRequest planning_request(const Keywords& keywords);
/// Nothing: a number of poses is asked for instead.
std::optional<TargetOptions> target_options(const Keywords& keywords);

/// What a calibration is asked for besides CalibrationOptions.
struct CalibrationRequest {
    CalibrationOptions options;
    std::optional<bool> prior;         ///< whether expected sizes are priors; nothing: as stated
    std::optional<bool> learns_sizes;  ///< nothing: as stated
    std::vector<std::string> free;     ///< errors to identify; empty: the campaign's
    EarlierUse earlier;
};
CalibrationRequest calibration_request(const Keywords& keywords);

StudyOptions study_options(const Keywords& keywords);
SimulatedStudyOptions simulated_study_options(const Keywords& keywords);
BlocksStudyOptions blocks_study_options(const Keywords& keywords);

}  // namespace posewise::python
