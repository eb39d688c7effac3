#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"
#include "estimates.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise::cli {

/// The command line of calibrate.
struct CalibrateArguments {
    InputPaths paths;
    std::string validate;
    std::optional<double> limit_mm;
    std::string predict;
    std::string predict_out;
    std::string csv;
    std::vector<std::string> free;
    std::string out;
    std::string page;
    std::string plot;
    std::string method = "lm";
    std::string search = "random";
    std::string loss = "squares";
    double length_error_percent = 30;
    double angle_error_deg = 20;
    std::optional<Index> iteration_limit;
    std::optional<bool> prior;
    std::string sizes;  ///< empty: as the campaign says
    bool has_all_parameters = false;
    std::string validation_campaign;
    EarlierArguments earlier;
    CalibrationOptions options;  ///< with the numbers that are options as they are
};

/// Every option but --measurements.
void add_calibrate_options(CLI::App& command, CalibrateArguments& arguments);

}  // namespace posewise::cli
