#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common.hpp"
#include "estimates.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::cli {

/// The campaign of a file, its expected sizes priors or not as asked, else as it says.
io::CampaignFile read_with_prior(const std::string& path, std::optional<bool> prior,
                                 const StopSignal& stop = {});

/// Noise, scales and errors that poses are planned with, a line each.
std::string describe_planned(const io::CampaignFile& campaign, double repeats);

/// A line that says so of a file that states errors to plan with, where they are not used.
std::string describe_unused_planning(const io::CampaignFile& campaign);

/// --plan, whose help begins with what else it is for, and --points-unit.
void add_points_options(CLI::App& command, std::string& plan, std::string& points_unit,
                        const std::string& plan_help, const std::string& plan_option = "--plan");

/// Paths of several measurements, each of the plan at its place. Throws InputError unless there are
/// as many plans, and all are different.
InputPaths pair_with_plans(InputPaths paths, const std::vector<std::string>& measurements,
                           const std::vector<std::string>& plans);

/// All files that the paths name.
std::vector<std::string> files_of(const InputPaths& paths);

/// Plans whose poses were measured.
struct MeasuredPlans {
    std::optional<Plan> all;    ///< as one, see io::join_plans(); nothing: none is stated
    std::vector<Plan> parts{};  ///< each by itself, where there are several
};
/// Those that the paths name: as plan writes them, JSON or CSV.
MeasuredPlans read_measured_plans(const InputPaths& paths, const io::CampaignFile& file);
io::PointsSource points_of(const InputPaths& paths, const std::optional<Plan>& plan);

/// What `read` finds in the files of the paths, see io::join_measurements().
using MeasurementsReader = io::MeasurementsFile(const std::string& path,
                                                const io::CampaignFile& file,
                                                const io::PointsSource& points);
io::MeasurementsFile read_of_plans(const InputPaths& paths, const io::CampaignFile& file,
                                   const MeasuredPlans& plans, MeasurementsReader& read);

/// io::read_measurements(). Warns of columns that are not used, of points that are missing, and of
/// configurations beyond the joint limits, which are taken, since they were measured.
io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& file,
                                   const io::PointsSource& points = {});

/// The same without regard to joint limits, where it is in question how the joints are meant.
io::MeasurementsFile read_as_stated(const std::string& path, const io::CampaignFile& file,
                                    const io::PointsSource& points);

/// read_measured() less what was excluded by hand, leave_out(). Warns of joints that never move,
/// and of what an earlier estimate would count twice.
io::MeasurementsFile read_measured_without(const std::vector<std::string>& excluded,
                                           const InputPaths& paths, const io::CampaignFile& file,
                                           const EarlierArguments& earlier,
                                           const MeasuredPlans& plans = {});

/// Throws InputError for options of points where none of what was read is a list of them, which is
/// joined, but has joint values and units of its own: --points-unit and, where it is for nothing
/// else, --plan.
void check_needs_unit(const InputPaths& paths, bool is_joined);
void check_needs_plan(const InputPaths& paths, bool is_joined,
                      const std::string& plan_option = "--plan");

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
