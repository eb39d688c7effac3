#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"
#include "estimates.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/task/study.hpp"

namespace posewise::cli {

/// The command line of study; what it does not say is as the campaign says.
struct StudyArguments {
    std::optional<bool> prior;
    EarlierArguments earlier;
    InputPaths paths;
    std::vector<std::string> excluded;
    std::vector<Criterion> criteria;
    std::vector<io::ErrorModel> models;
    double least_distance_deg = 0;
    std::optional<std::uint64_t> seed;
    std::string csv;
    std::string plot;
    bool progress = false;
    StudyOptions options;
};

/// Every option but --measurements.
void add_study_options(CLI::App& command, StudyArguments& arguments);

}  // namespace posewise::cli
