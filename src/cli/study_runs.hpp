#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "study_options.hpp"

namespace posewise::cli {

/// The study of measured configurations; of each error model, if several are asked for. `notes` are
/// lines for below the tables.
std::vector<Study> study_measured(const StudyArguments& arguments, const CommonOptions& common,
                                  const StopSignal& stop, std::string& notes);

/// The study of robots that are drawn; of each variation, if some are asked for.
std::vector<Study> study_simulated(const StudyArguments& arguments, const CommonOptions& common,
                                   const StopSignal& stop, std::string& notes);

/// Everything that a store holds.
std::vector<Study> read_store(const std::string& path);

}  // namespace posewise::cli
