#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"
#include "estimates.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/study.hpp"

namespace posewise::cli {

/// What study takes of plain blocks, in the place of a campaign.
struct BlocksStudyArguments {
    std::string blocks;
    PlanSources sources;  ///< layout of the file, and poses measured already
    std::vector<std::string> subsets;
};

/// The command line of study; what it does not say is as the campaign says.
struct StudyArguments {
    std::optional<bool> prior;
    EarlierArguments earlier;
    InputPaths paths;
    std::vector<std::string> excluded;
    std::vector<Criterion> criteria;
    std::vector<io::ErrorModel> models;
    double least_distance_deg = 0;
    std::optional<Index> random_subsets;
    std::optional<std::uint64_t> seed;
    std::optional<double> proof;  ///< s, as --effort says; of plain blocks only
    double time_limit = 0;        ///< s; 0: none
    std::string csv;
    std::string plot;
    std::string page;
    bool progress = false;
    SimulatedStudyOptions options;  ///< but for what stands here by itself

    bool is_simulated = false;
    std::string truth;
    std::vector<std::string> varied;
    Index points = 0;  ///< that fill the ranges varied
    std::optional<Index> trials;

    BlocksStudyArguments plain;

    std::string store;
    std::vector<std::string> merged;
};

/// Every option but --measurements and those of simulated studies.
void add_study_options(CLI::App& command, StudyArguments& arguments);

/// --simulate and what goes with it.
void add_simulation_options(CLI::App& command, StudyArguments& arguments);

/// --blocks and what goes with it.
void add_blocks_study_options(CLI::App& command, StudyArguments& arguments);

/// --store, --shard, --merge.
void add_store_options(CLI::App& command, StudyArguments& arguments);

}  // namespace posewise::cli
