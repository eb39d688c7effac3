#pragma once

#include "study_options.hpp"

namespace posewise::cli {

/// study --blocks: value and efficiency of plain blocks against the number of poses. Throws a usage
/// error for options that need a robot.
void study_blocks(const CLI::App& command, const StudyArguments& arguments,
                  const CommonOptions& common);

}  // namespace posewise::cli
