#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "estimates.hpp"
#include "posewise/io/measurements_file.hpp"

namespace posewise::cli {

/// The campaign of a file, its expected sizes priors or not as asked, else as it says.
io::CampaignFile read_with_prior(const std::string& path, std::optional<bool> prior,
                                 const StopSignal& stop = {});

/// Noise, scales and errors that poses are planned with, a line each.
std::string describe_planned(const io::CampaignFile& campaign, double repeats);

/// A line that says so of a file that states errors to plan with, where they are not used.
std::string describe_unused_planning(const io::CampaignFile& campaign);

/// io::read_measurements(). Configurations beyond the joint limits are taken, since they were
/// measured; a warning on standard error says so.
Measurements read_measured(const std::string& path, const io::CampaignFile& file);

/// The same less what was excluded by hand, leave_out(). Warns of joints that never move, and of
/// what an earlier estimate would count twice.
Measurements read_measured_without(const std::vector<std::string>& excluded,
                                   const std::string& path, const io::CampaignFile& file,
                                   const EarlierArguments& earlier);
/// --exclude, as leave_out() takes it.
void add_exclude_option(CLI::App& command, std::vector<std::string>& excluded);

/// Warns of describe_unchecked_bodies().
void warn_of_unchecked_bodies(const io::CampaignFile& file);

/// Warns of configurations of a file that the campaign's cell does not allow.
void warn_of_violations(const std::string& path, const io::CampaignFile& file,
                        const io::Configurations& configurations);

/// io::read_program(), with the warning of read_measured().
io::Configurations read_unlimited(const std::string& path, const io::CampaignFile& file);

}  // namespace posewise::cli
