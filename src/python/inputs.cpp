#include "inputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "posewise/core/errors.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::python {
namespace {

/// Throws InputError with the faults, or warns of them if they are forced.
void refuse(const std::vector<std::string>& faults, const char* what, bool is_forced,
            Sentences& warnings) {
    if (faults.empty()) return;
    const std::string words = fmt::format("{}: {}", what, fmt::join(faults, "; "));
    if (!is_forced) throw InputError(words + "; force=True takes it all the same");
    warnings.push_back(words);
}

void warn_beyond_limits(const Campaign& campaign, const RowMatrixXd& configurations,
                        const std::vector<std::string>& ids, Sentences& warnings) {
    if (const auto beyond = find_beyond_limits(campaign, configurations)) {
        warnings.push_back(describe(*beyond, ids));
    }
}

void add_passed_over(const io::MeasurementsFile& measured, Sentences& warnings) {
    for (std::string& sentence : io::describe_passed_over(measured)) {
        warnings.push_back(std::move(sentence));
    }
}

io::MeasurementsFile read_as_stated(const std::string& path, const io::CampaignFile& campaign,
                                    Sentences& warnings, const io::PointsSource& points) {
    io::MeasurementsFile measured = io::read_measurements(path, campaign, points);
    add_passed_over(measured, warnings);
    return measured;
}

io::MeasurementsFile without(const std::vector<std::string>& excluded,
                             io::MeasurementsFile measured, const Campaign& campaign,
                             Sentences& warnings) {
    static_cast<Measurements&>(measured) = leave_out(measured, excluded);
    warn_beyond_limits(campaign, measured.configurations, measured.ids, warnings);
    const std::vector<Index> still = find_still_joints(campaign, measured.configurations);
    if (!still.empty()) warnings.push_back(describe_still_joints(campaign, still));
    return measured;
}

}  // namespace

Earlier read_earlier(const std::string& path, const Campaign& campaign, const EarlierUse& use,
                     bool is_forced, Sentences& warnings) {
    const io::EarlierFile earlier = io::read_earlier(path, campaign, use);
    if (!earlier.changes.empty()) {
        warnings.push_back(fmt::format("the campaign said otherwise when the estimate was made: {}",
                                       fmt::join(earlier.changes, "; ")));
    }
    refuse(io::find_faults(campaign, earlier), "the estimate is no calibration to use", is_forced,
           warnings);
    return earlier;
}

io::CampaignFile planned_campaign(const io::CampaignFile& campaign, const PlanCall& asked,
                                  const StopSignal& stop, Sentences& warnings) {
    const std::string& estimate = asked.request.sources.estimate;
    if (estimate.empty()) return io::planned_campaign(campaign, asked.prior, stop);
    io::CampaignFile file = campaign;
    io::set_prior(file, asked.prior, stop);
    file.planned_model.reset();
    static_cast<Campaign&>(file) = with_earlier(
        file, read_earlier(estimate, file, asked.request.earlier, asked.is_forced, warnings));
    return file;
}

io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& campaign,
                                   const std::vector<std::string>& excluded, Sentences& warnings,
                                   const io::PointsSource& points) {
    return without(excluded, read_as_stated(path, campaign, warnings, points), campaign, warnings);
}

io::MeasurementsFile read_planned(const CalibrationCall& asked, const io::CampaignFile& campaign,
                                  std::optional<Plan>& plan, Sentences& warnings) {
    std::vector<Plan> plans;
    for (const std::string& path : asked.plans) plans.push_back(io::read_plan(path));
    std::vector<io::MeasurementsFile> parts;
    for (std::size_t k = 0; k < asked.measurements.size(); ++k) {
        const io::PointsSource points =
            k < plans.size() ? io::PointsSource{&plans[k], asked.plans[k], asked.points_unit}
                             : io::PointsSource{};
        parts.push_back(read_as_stated(asked.measurements[k], campaign, warnings, points));
    }
    if (plans.size() > 1) {
        plan = io::join_plans(std::move(plans), asked.plans, campaign);
        parts = {io::join_measurements(std::move(parts), asked.measurements, asked.plans)};
        add_passed_over(parts.front(), warnings);
    } else if (!plans.empty()) {
        plan = std::move(plans.front());
    }
    return without(asked.options.excluded, std::move(parts.front()), campaign, warnings);
}

JudgeCalibration judge(bool is_forced, Sentences& warnings) {
    return [is_forced, &warnings](const Calibration& calibration) {
        for (std::string& sentence : describe_doubts(calibration)) {
            warnings.push_back(std::move(sentence));
        }
        refuse(calibration.faults, "this is no calibration", is_forced, warnings);
    };
}

ChoiceInputs read_choice(const PlanCall& asked, const io::CampaignFile& campaign,
                         Sentences& warnings) {
    ChoiceInputs inputs;
    ChoiceOptions& options = inputs.options;
    static_cast<PlanRequest&>(options) = asked.request;
    options.groups = asked.groups;
    const PlanSources& sources = options.sources;
    if (asked.kind == CandidateKind::Random) {
        inputs.candidates =
            random_candidates(campaign, asked.random_count, options.seed.value_or(campaign.seed));
    } else if (asked.kind == CandidateKind::Measurements) {
        inputs.candidates =
            measured_candidates(read_measured(sources.candidates, campaign, {}, warnings));
    } else {
        io::Configurations read = io::read_configurations(sources.candidates, campaign);
        inputs.candidates = {asked.kind,
                             std::move(read.ids),
                             std::move(read.joints),
                             read.is_seen.cast<double>(),
                             std::nullopt,
                             {}};
    }
    if (!sources.augment.empty()) {
        options.held = read_measured(sources.augment, campaign, {}, warnings);
    }
    if (!sources.test_poses.empty()) {
        options.test_poses = io::read_configurations(sources.test_poses, campaign).joints;
    }
    return inputs;
}

PlanningOptions read_planning(const PlanRequest& request, const io::CampaignFile& campaign,
                              Sentences& warnings) {
    PlanningOptions options;
    static_cast<PlanRequest&>(options) = request;
    const PlanSources& sources = options.sources;
    if (!sources.augment.empty()) {
        options.held = read_measured(sources.augment, campaign, {}, warnings);
    }
    if (!sources.workspace.empty()) {
        options.workspace = io::read_configurations(sources.workspace, campaign).joints;
    }
    return options;
}

ChoiceOptions read_plain(const PlainBlocks& blocks, const PlanRequest& request,
                         const std::vector<Index>& groups) {
    ChoiceOptions options;
    static_cast<PlanRequest&>(options) = request;
    options.groups = groups;
    options.sources.rows_per_block = blocks.rows;
    Blocks& held = options.held_blocks;
    if (blocks.held_count > 0) {
        held = make_equal_blocks(blocks.held, blocks.held.rows() / blocks.held_count);
    }
    held.matrix.conservativeResize(blocks.held.rows() + blocks.prior.rows(),
                                   blocks.candidates.cols());
    held.matrix.bottomRows(blocks.prior.rows()) = blocks.prior;
    if (blocks.test_poses.rows() > 0) {
        options.test_blocks = make_equal_blocks(blocks.test_poses, blocks.rows);
    }
    return options;
}

}  // namespace posewise::python
