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

io::CampaignFile planned_campaign(const io::CampaignFile& campaign, const PlanRequest& request,
                                  std::optional<bool> prior, const std::string& estimate,
                                  bool is_forced, Sentences& warnings) {
    if (estimate.empty()) return io::planned_campaign(campaign, prior);
    io::CampaignFile file = campaign;
    io::set_prior(file, prior);
    file.planned_model.reset();
    static_cast<Campaign&>(file) =
        with_earlier(file, read_earlier(estimate, file, request.earlier, is_forced, warnings));
    return file;
}

io::MeasurementsFile read_measured(const std::string& path, const io::CampaignFile& campaign,
                                   const std::vector<std::string>& excluded, Sentences& warnings,
                                   const io::PointsSource& points) {
    io::MeasurementsFile measured = io::read_measurements(path, campaign, points);
    for (std::string& sentence : io::describe_passed_over(measured)) {
        warnings.push_back(std::move(sentence));
    }
    static_cast<Measurements&>(measured) = leave_out(measured, excluded);
    warn_beyond_limits(campaign, measured.configurations, measured.ids, warnings);
    const std::vector<Index> still = find_still_joints(campaign, measured.configurations);
    if (!still.empty()) warnings.push_back(describe_still_joints(campaign, still));
    return measured;
}

JudgeCalibration judge(bool is_forced, Sentences& warnings) {
    return [is_forced, &warnings](const Calibration& calibration) {
        for (std::string& sentence : describe_doubts(calibration)) {
            warnings.push_back(std::move(sentence));
        }
        refuse(calibration.faults, "this is no calibration", is_forced, warnings);
    };
}

ChoiceInputs read_choice(const ChoiceTables& tables, const io::CampaignFile& campaign,
                         const PlanRequest& request, const std::vector<Index>& groups,
                         Sentences& warnings) {
    ChoiceInputs inputs;
    static_cast<PlanRequest&>(inputs.options) = request;
    inputs.options.groups = groups;
    if (tables.kind == CandidateKind::Random) {
        inputs.candidates =
            random_candidates(campaign, tables.random_count, request.seed.value_or(campaign.seed));
    } else if (tables.kind == CandidateKind::Measurements) {
        inputs.candidates =
            measured_candidates(read_measured(tables.candidates, campaign, {}, warnings));
    } else {
        io::Configurations read = io::read_configurations(tables.candidates, campaign);
        inputs.candidates = {tables.kind,
                             std::move(read.ids),
                             std::move(read.joints),
                             read.is_seen.cast<double>(),
                             std::nullopt,
                             {}};
    }
    if (!tables.held.empty()) {
        inputs.options.held = read_measured(tables.held, campaign, {}, warnings);
    }
    if (!tables.test_poses.empty()) {
        inputs.options.test_poses = io::read_configurations(tables.test_poses, campaign).joints;
    }
    return inputs;
}

PlanningOptions read_planning(const PlanningTables& tables, const io::CampaignFile& campaign,
                              const PlanRequest& request, Sentences& warnings) {
    PlanningOptions options;
    static_cast<PlanRequest&>(options) = request;
    if (!tables.held.empty()) {
        options.held = read_measured(tables.held, campaign, {}, warnings);
    }
    if (!tables.workspace.empty()) {
        options.workspace = io::read_configurations(tables.workspace, campaign).joints;
    }
    return options;
}

ChoiceOptions read_plain(const PlainBlocks& blocks, const PlanRequest& request,
                         const std::vector<Index>& groups) {
    ChoiceOptions options;
    static_cast<PlanRequest&>(options) = request;
    options.groups = groups;
    options.sources.rows_per_block = blocks.rows;
    if (blocks.held.rows() > 0) {
        const Index rows =
            blocks.held_count > 0 ? blocks.held.rows() / blocks.held_count : blocks.held.rows();
        options.held_blocks = make_equal_blocks(blocks.held, rows);
    }
    if (blocks.test_poses.rows() > 0) {
        options.test_blocks = make_equal_blocks(blocks.test_poses, blocks.rows);
    }
    return options;
}

}  // namespace posewise::python
