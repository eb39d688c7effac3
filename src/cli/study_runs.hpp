#pragma once

#include <string>
#include <vector>

#include "page.hpp"
#include "study_options.hpp"

namespace posewise::cli {

/// What goes with the tables of a study.
struct StudyExtras {
    std::string notes;  ///< lines below them
    io::PagePart page;  ///< what a page shows besides
};

/// Throws InputError as check_outputs(), the store and its kind included.
void check_study_outputs(const StudyArguments& arguments,
                         const std::vector<const io::CampaignFile*>& campaigns,
                         std::vector<std::string> inputs, const CommonOptions& common);

/// The study of measured configurations; of each error model, if several are asked for.
std::vector<Study> study_measured(const StudyArguments& arguments, const CommonOptions& common,
                                  const StopSignal& stop, StudyExtras& extras);

/// The study of robots that are drawn; of each variation, if some are asked for.
std::vector<Study> study_simulated(const StudyArguments& arguments, const CommonOptions& common,
                                   const StopSignal& stop, StudyExtras& extras);

/// Everything that a store holds.
std::vector<Study> read_store(const std::string& path);
/// The same, those together that one table can show; without those of which no pose count is
/// complete. Throws InputError if there is nothing else.
std::vector<std::vector<Study>> read_store_groups(const std::string& path);

/// The tables of studies of error models or variations, or of one.
std::string describe_studies(const std::vector<Study>& studies);

}  // namespace posewise::cli
