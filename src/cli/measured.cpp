#include "measured.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common.hpp"
#include "core/text.hpp"
#include "files.hpp"
#include "io/measurements/points_list.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {
namespace {

void warn_beyond_limits(const std::string& path, const io::CampaignFile& file,
                        const RowMatrixXd& configurations, const std::vector<std::string>& ids) {
    if (const auto beyond = find_beyond_limits(file, configurations)) {
        print_warning(path + ": " + describe(*beyond, ids));
    }
}

std::string times(std::size_t count) {
    return count == 1 ? "once" : detail::count_of(static_cast<Index>(count), "time");
}

/// Throws InputError if a path was stated before.
void check_is_new(const std::vector<std::string>& paths, std::size_t place, const char* reason) {
    const auto here = paths.begin() + static_cast<std::ptrdiff_t>(place);
    if (std::find(paths.begin(), here, *here) == here) return;
    throw input_error_at({*here}, fmt::format("is stated twice; must be stated once: {}", reason));
}

std::vector<std::string> plan_paths(const InputPaths& paths) {
    std::vector<std::string> plans;
    for (const InputPaths& part : paths.parts) plans.push_back(part.plan);
    return plans;
}

/// Says what the reader passed over.
void warn_of_passed_over(const std::string& path, const io::MeasurementsFile& measured) {
    for (const std::string& sentence : io::describe_passed_over(measured)) {
        print_warning(path + ": " + sentence);
    }
}

}  // namespace

io::CampaignFile read_with_prior(const std::string& path, std::optional<bool> prior,
                                 const StopSignal& stop) {
    io::CampaignFile file = io::read_campaign(path, stop);
    io::set_prior(file, prior, stop);
    return file;
}

std::string describe_planned(const io::CampaignFile& campaign, double repeats) {
    std::string text = detail::describe_scaling(campaign, repeats);
    if (campaign.planned_model) {
        text += "errors: " + std::string(io::error_model_name(*campaign.planned_model)) +
                ", as planning.errors says: the accuracy predicted is that of a calibration that "
                "fits these, calibrate fits those of robot.errors\n";
    }
    return text;
}

std::string describe_unused_planning(const io::CampaignFile& campaign) {
    if (!campaign.planned_model) return "";
    return fmt::format("planning.errors, {}, is for select and plan, and not used here\n",
                       io::error_model_name(*campaign.planned_model));
}

void add_points_options(CLI::App& command, std::string& plan, std::string& points_unit,
                        const std::string& plan_help, const std::string& plan_option) {
    command.add_option(plan_option, plan, plan_help + " (its JSON, or its configurations as CSV)")
        ->check(file_name());
    command
        .add_option("--points-unit", points_unit,
                    "Unit of a list of points that does not state it: mm, m, um or inch")
        ->check(CLI::IsMember(detail::point_unit_names()));
}

InputPaths pair_with_plans(InputPaths paths, const std::vector<std::string>& measurements,
                           const std::vector<std::string>& plans) {
    paths.measurements = fmt::format("{}", fmt::join(measurements, ", "));
    paths.plan = fmt::format("{}", fmt::join(plans, ", "));
    if (measurements.size() < 2 && plans.size() < 2) return paths;
    if (measurements.size() != plans.size()) {
        throw InputError(
            fmt::format("--measurements is stated {}, --plan {}; must be equally "
                        "often, so that each file has the plan whose poses it is of",
                        times(measurements.size()), times(plans.size())));
    }
    for (std::size_t i = 0; i < plans.size(); ++i) {
        check_is_new(plans, i, "repeats need a table with the columns config and sample");
        check_is_new(measurements, i, "each plan has its own measurements");
        paths.parts.push_back({paths.campaign, measurements[i], plans[i], paths.points_unit});
    }
    return paths;
}

std::vector<std::string> files_of(const InputPaths& paths) {
    if (paths.parts.empty()) return {paths.measurements, paths.plan};
    std::vector<std::string> files;
    for (const InputPaths& part : paths.parts) {
        files.insert(files.end(), {part.measurements, part.plan});
    }
    return files;
}

MeasuredPlans read_measured_plans(const InputPaths& paths, const io::CampaignFile& file) {
    if (paths.plan.empty()) return {};
    if (paths.parts.empty()) return {io::read_plan(paths.plan, file), {}};
    std::vector<Plan> parts;
    for (const InputPaths& part : paths.parts) parts.push_back(io::read_plan(part.plan, file));
    return {io::join_plans(parts, plan_paths(paths), file), parts};
}

io::MeasurementsFile read_of_plans(const InputPaths& paths, const io::CampaignFile& file,
                                   const MeasuredPlans& plans, MeasurementsReader& read) {
    if (paths.parts.empty()) return read(paths.measurements, file, points_of(paths, plans.all));
    std::vector<io::MeasurementsFile> measured;
    std::vector<std::string> files;
    for (std::size_t k = 0; k < paths.parts.size(); ++k) {
        const InputPaths& part = paths.parts[k];
        measured.push_back(read(part.measurements, file, points_of(part, plans.parts[k])));
        files.push_back(part.measurements);
    }
    return io::join_measurements(std::move(measured), files, plan_paths(paths));
}

io::PointsSource points_of(const InputPaths& paths, const std::optional<Plan>& plan) {
    return {plan ? &*plan : nullptr, paths.plan, paths.points_unit};
}

void check_needs_unit(const InputPaths& paths, bool is_joined) {
    if (is_joined || paths.points_unit.empty()) return;
    throw input_error_at({paths.measurements},
                         "has units of its own; --points-unit must be left out");
}

void check_needs_plan(const InputPaths& paths, bool is_joined, const std::string& plan_option) {
    if (is_joined || paths.plan.empty()) return;
    throw input_error_at({paths.measurements},
                         "has joint values of its own; " + plan_option + " must be left out");
}

io::MeasurementsFile read_as_stated(const std::string& path, const io::CampaignFile& file,
                                    const io::PointsSource& points) {
    io::MeasurementsFile measured = io::read_measurements(path, file, points);
    warn_of_passed_over(path, measured);
    return measured;
}

io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& file,
                                   const io::PointsSource& points) {
    io::MeasurementsFile measured = read_as_stated(path, file, points);
    warn_beyond_limits(path, file, measured.configurations, measured.ids);
    return measured;
}

io::MeasurementsFile read_measured_without(const std::vector<std::string>& excluded,
                                           const InputPaths& paths, const io::CampaignFile& file,
                                           const EarlierArguments& earlier,
                                           const MeasuredPlans& plans) {
    const std::string& path = paths.measurements;
    io::MeasurementsFile measured = read_of_plans(paths, file, plans, read_as_stated);
    if (!paths.parts.empty()) warn_of_passed_over(path, measured);
    warn_of_counting_twice(earlier.from, earlier.is_prior, path, measured);
    static_cast<Measurements&>(measured) =
        compute_from(path, [&] { return leave_out(measured, excluded); });
    warn_beyond_limits(path, file, measured.configurations, measured.ids);
    const std::vector<Index> still = find_still_joints(file, measured.configurations);
    if (!still.empty()) print_warning(path + ": " + describe_still_joints(file, still));
    return measured;
}

void add_exclude_option(CLI::App& command, std::vector<std::string>& excluded) {
    add_ids_option(
        command, "--exclude", excluded,
        "Leave out these configurations (ids, by commas; 7-12 are all from 7 to 12 in the "
        "file's order) and samples (7:2 has 7 in the column config and 2 in the column "
        "sample; without such a column it is the second sample of 7)");
}

void warn_of_unchecked_bodies(const io::CampaignFile& file) {
    const std::string unchecked = describe_unchecked_bodies(file);
    if (!unchecked.empty()) print_warning(unchecked);
}

void warn_of_violations(const std::string& path, const io::CampaignFile& file,
                        const io::Configurations& configurations) {
    const Constraints constraints(file, file.cell, false);
    const std::string words =
        describe(find_violations(constraints, configurations.joints), configurations.ids);
    if (!words.empty()) print_warning(path + ": " + words);
}

io::Configurations read_unlimited(const std::string& path, const io::CampaignFile& file) {
    io::Configurations read = io::read_program(path, file);
    warn_beyond_limits(path, file, read.joints, read.ids);
    return read;
}

}  // namespace posewise::cli
