#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/plan.hpp"

/// Estimates that may reach a robot or be built on, and such as must not.
namespace posewise::cli {

/// What was identified must not be used: exit code 3.
class NoCalibration : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// --force: an estimate with faults is taken all the same.
CLI::Option* add_force_option(CLI::App& command, bool& is_forced);

/// What a sentence begins with that says why a calibration must not be used.
inline constexpr std::string_view no_calibration = "this is no calibration: ";

/// For what is built on measurements: warns of the doubts about what those in a file calibrate,
/// once each. With faults it throws NoCalibration, or warns if it is forced.
JudgeCalibration judge_of(const std::string& measurements, bool is_forced);

/// "it did not converge (iteration limit); ...", the first few.
std::string join_some(const std::vector<std::string>& texts);

/// An option that takes base, targets or both (base,targets).
CLI::Option* add_parts_option(CLI::App& command, const std::string& name,
                              std::vector<std::string>& parts, const std::string& description);

/// The estimate in a file. Throws InputError if it is of another robot, or has faults and is not
/// forced, see find_faults(). Warns where noise or sizes were stated differently when it was made.
Estimate read_usable_estimate(const std::string& path, const Campaign& campaign, bool is_forced);

/// The command line of an earlier estimate.
struct EarlierArguments {
    std::string from;
    bool is_prior = false;
    std::vector<std::string> only;
    std::vector<std::string> moved;
    double drift_mm = 0.02;
    double drift_offset_mrad = 0.1;
    double drift_mrad = 0.02;
    bool is_forced = false;

    EarlierUse use() const;
    /// Whether more than a start comes from the estimate.
    bool builds_on() const { return is_prior || !only.empty(); }
};

/// --from and --force.
CLI::Option* add_from_option(CLI::App& command, EarlierArguments& arguments);
/// These, and --as-prior, --moved, --drift-..., --only.
void add_earlier_options(CLI::App& command, EarlierArguments& arguments);
/// --force takes what measurements tell, too, and does not need --from.
void let_force_take_measured(CLI::App& command);

/// The estimate in a file, as read_usable_estimate().
Earlier read_usable_earlier(const std::string& path, const Campaign& campaign,
                            const EarlierUse& use, bool is_forced);

/// Makes the campaign what --from says; nothing without it.
void expect_earlier(io::CampaignFile& file, const EarlierArguments& arguments);

/// The campaign that poses are planned with: as an estimate says, if the sources name one, then
/// with the errors of robot.errors; else as its file says.
io::CampaignFile read_planned(const PlanSources& sources, const EarlierUse& use,
                              std::optional<bool> prior, bool is_forced,
                              const StopSignal& stop = {});

/// Warns where measurements that an estimate was made from would count twice, it being the prior.
void warn_of_counting_twice(const std::string& estimate, bool is_prior, const std::string& path,
                            const Measurements& measured);

/// A line: which estimate, and how it is used; nothing without one.
std::string describe_earlier(const std::string& path, const EarlierUse& use);
std::string describe_earlier(const PlanRequest& request);
/// That what is not to be identified is taken as exact.
std::string describe_exact(const EarlierUse& use);
inline std::string describe_earlier(const EarlierArguments& arguments) {
    return describe_earlier(arguments.from, arguments.use());
}

/// Of an estimate that the command makes from measurements in a file: these, the campaign and the
/// options that were said and matter to it.
io::Provenance provenance_of(const CLI::App& command, const io::CampaignFile& file,
                             const std::string& path, const Measurements& measured);

}  // namespace posewise::cli
