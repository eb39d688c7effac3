#include "plan_report.hpp"

#include <fmt/format.h>

#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "interrupt.hpp"
#include "measured.hpp"
#include "plot.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/scene.hpp"
#include "report/plot.hpp"

namespace posewise::cli {
namespace {

std::string describe(const MadePlan& plan, const std::vector<CountAccuracy>& counts) {
    const Planning& planning = *plan.made.planning;
    const bool has_target = plan.made.ending != TargetEnding::NotRun;
    std::string text = (has_target ? format(plan.made) : "") +
                       describe_verified(plan.made, plan.simulated) + format_planning(planning) +
                       format_budget(planning);
    text += has_target ? format_curve(plan.made)
            : planning.plan.is_stopped_early()
                ? "\nPredicted position error by number of poses: left out, planning was stopped\n"
                : format_other_counts(counts);
    text += (plan.simulated ? format(*plan.simulated) : "") + format_deviations(planning.plan);
    return text + fmt::format("\n{}{}plan:        {}\n",
                              describe_planned(plan.campaign, planning.plan.request.repeats),
                              describe_earlier(planning.plan.request),
                              detail::escape_controls(plan.out));
}

}  // namespace

void report_plan(const MadePlan& plan, const std::string& page, const std::string& plot,
                 const CommonOptions& common) {
    const Planning& planning = *plan.made.planning;
    const bool has_target = plan.made.ending != TargetEnding::NotRun;
    const bool is_stopped = planning.plan.is_stopped_early();
    std::vector<CountAccuracy> counts;
    if (!is_stopped && !has_target) {
        const InterruptFlag interrupted("interrupted twice; the plan is written");
        counts = predict_other_counts(planning, {interrupted.get(), plan.options.stop.deadline});
    }
    if (is_stopped) print_warning("stopped early; the plan is the best so far");
    const Printed printed{
        has_target ? answer(plan.made, plan.simulated) : answer(planning, counts, plan.simulated),
        describe(plan, counts), [&] {
            return has_target ? io::to_json(plan.made, plan.out, plan.simulated)
                              : io::to_json(planning, counts, plan.out, plan.simulated);
        }};
    io::PagePart part;
    if (!page.empty()) part = show_plan(planning.plan, planning.campaign, plan.options);
    print(printed, common);
    write_page(page, std::move(part), printed, common);
    if (plot.empty()) return;
    const Scene scene = make_scene(planning.campaign);
    draw_plot(plot, [&](const std::string& image) {
        return detail::plan_plot_script(planning.plan, scene, image);
    });
}

io::PagePart show_plan(const Plan& plan, const Campaign& campaign, const PlanningOptions& options) {
    io::PagePart part;
    part.title = campaign.name;
    const bool is_measured = options.held && !campaign.has_nominal_base;
    part.scene = make_scene(campaign, is_measured ? &*options.held : nullptr);
    part.first_pose = plan.poses.front().configuration;
    part.expected = io::page_expected(campaign, plan);
    part.error_map = map_if_possible([&] { return map_errors(plan, campaign, options); });
    return part;
}

io::PagePart show_choice(const Plan& plan, const ChoiceInputs& inputs) {
    io::PagePart part;
    if (!inputs.campaign) {
        part.title = plan.request.sources.candidates;
        return part;
    }
    const Campaign& campaign = *inputs.campaign;
    const auto& measured = inputs.candidates.measured;
    const auto& held = inputs.options.held;
    const bool is_held = held && !campaign.has_nominal_base;
    part.title = campaign.name;
    part.scene = make_scene(campaign, measured ? &*measured : is_held ? &*held : nullptr);
    part.first_pose = plan.poses.front().configuration;
    part.error_map = map_if_possible([&] {
        const Candidates drawn =
            plan.kind == CandidateKind::Random
                ? random_candidates(campaign, plan.candidate_count, plan.request.seed.value())
                : inputs.candidates;
        return map_errors(plan, campaign, drawn, inputs.options);
    });
    return part;
}

}  // namespace posewise::cli
