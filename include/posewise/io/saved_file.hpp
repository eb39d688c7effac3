#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/task/planning.hpp"

/// Files that commands have written, read again for those who look at them.
namespace posewise::io {

enum class SavedKind {
    Plan,      ///< a plan file, or what select --json or plan --json printed
    Estimate,  ///< from calibrate
    Study,     ///< what study --json printed
    Export,    ///< what export --json printed
    Trials,    ///< a store, of study --store
};

/// What a file is, by its content. Throws InputError for one that is none of these.
SavedKind kind_of_saved(const std::string& path);

/// The document in the file of a plan, an estimate, a study or an export; of a plan of format 1 one
/// of format 2 with as much as there is. Throws InputError for another kind or a format that is not
/// known.
std::string read_saved_document(const std::string& path, SavedKind kind);

/// The document of a plan with what judge_again() said of it, unless it holds that already.
std::string read_saved_plan(const std::string& path, const Planning& judged);
/// The same of a choice.
std::string read_saved_plan(const std::string& path, const Plan& judged);

/// What an estimate's file says of how it was made.
struct EstimateRecord {
    std::string campaign;  ///< its name
    Provenance made_from;  ///< paths as they were typed then
    std::vector<std::string> excluded;
    Index folds = 0;  ///< that were held out; 0: none
    Loss loss;

    /// Whether that option was said.
    bool has_option(const std::string& name) const;
};
EstimateRecord read_estimate_record(const std::string& path);

}  // namespace posewise::io
