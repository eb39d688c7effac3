#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "plan_options.hpp"

namespace posewise::cli {

/// The command line of select.
struct SelectArguments : RequestArguments {
    std::string measurements;
    std::string candidates;
    std::string blocks;
    Index random = 0;  ///< how many; 0: others
    double least_distance_deg = 0;
    bool relaxes = false;  ///< weights instead of a choice
    int digits = 8;
    std::string page;
};

void add_select_options(CLI::App& command, SelectArguments& arguments);

/// Throws a usage error for options that contradict each other.
void check_select_usage(const SelectArguments& arguments);

}  // namespace posewise::cli
