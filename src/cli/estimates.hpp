#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>
#include <string>

#include "posewise/calibrator/estimate.hpp"

/// Estimates that may reach a robot, and such as must not.
namespace posewise::cli {

/// What was identified must not be used: exit code 3.
class NoCalibration : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// --force: an estimate with faults is taken all the same.
void add_force_option(CLI::App& command, bool& is_forced);

/// "it did not converge (iteration limit); ...".
std::string join_faults(const std::vector<std::string>& faults);

/// The estimate in a file. Throws InputError if it is of another robot, or has faults and is not
/// forced, see find_faults().
Estimate read_usable_estimate(const std::string& path, const Campaign& campaign, bool is_forced);

}  // namespace posewise::cli
