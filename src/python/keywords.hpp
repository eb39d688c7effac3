#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/format/json.hpp"
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

/// What was asked of select and plan besides the library's request. Its sources are paths.
struct PlanCall {
    PlanRequest request;
    std::optional<bool> prior;  ///< whether expected sizes are priors; nothing: as stated
    bool is_forced = false;     ///< takes what should not be used

    // Of select.
    CandidateKind kind = CandidateKind::Configurations;
    Index random_count = 0;     ///< for kind Random
    std::vector<Index> groups;  ///< label of each candidate; empty: none
};
PlanCall choice_call(const Keywords& keywords);
PlanCall planning_call(const Keywords& keywords);
/// Nothing: a number of poses is asked for instead.
std::optional<TargetOptions> target_options(const Keywords& keywords);

/// What was asked of a calibration. Paths of files are empty where there is none.
struct CalibrationCall {
    CalibrationOptions options;
    std::vector<std::string> measurements;
    std::vector<std::string> plans;  ///< of these measurements; empty: none
    std::string points_unit;
    std::string validation;
    std::string estimate;
    EarlierUse earlier;
    std::optional<bool> prior;         ///< as of PlanCall
    std::optional<bool> learns_sizes;  ///< nothing: as stated
    std::vector<std::string> free;     ///< errors to identify; empty: the campaign's
    bool is_forced = false;
};
CalibrationCall calibration_call(const Keywords& keywords);

/// What was asked of a study of a campaign.
struct StudyCall {
    SimulatedStudyOptions options;
    std::string measurements;  ///< path of the file; empty: simulated
    std::vector<std::string> excluded;
    std::optional<bool> prior;
    bool is_forced = false;
};
StudyCall study_call(const Keywords& keywords);
BlocksStudyOptions blocks_study_options(const Keywords& keywords);

}  // namespace posewise::python
