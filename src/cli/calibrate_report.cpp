#include "calibrate_report.hpp"

#include <fmt/format.h>

#include "core/text.hpp"
#include "plot.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/scene.hpp"
#include "report/plot.hpp"

namespace posewise::cli {
namespace {

/// Which estimate it goes on from.
std::string describe_start(const CalibrateArguments& arguments) {
    const EarlierArguments& earlier = arguments.earlier;
    if (earlier.from.empty()) return "";
    if (earlier.builds_on()) return '\n' + describe_earlier(earlier);
    return fmt::format("\nfrom:       {}: where it began\n", detail::escape_controls(earlier.from));
}

/// At the poses that it was judged at.
std::vector<std::pair<std::string, io::PageResiduals>> judged_residuals(
    const Calibration& result, const Measurements& measured, const CalibrationOptions& options) {
    std::vector<std::pair<std::string, io::PageResiduals>> judged;
    const auto add = [&](const char* poses, const Measurements& others, const Campaign& campaign,
                         const Parameters& parameters) {
        judged.emplace_back(
            poses,
            io::page_residuals(campaign, others, list_residuals(campaign, parameters, others)));
    };
    const Parameters& found = result.estimate.parameters;
    if (result.validation && result.refitted) {
        add("validation", *options.validation, *result.refitted, result.refitted->nominal);
        judged.back().second.has_own_set_up = true;
    } else if (result.validation) {
        add("validation", *options.validation, result.campaign, found);
    }
    if (result.verification) {
        add("verification", take(measured, options.verification), result.campaign, found);
    }
    if (result.left_out) {
        std::vector<Index> known = options.used;
        known.insert(known.end(), options.verification.begin(), options.verification.end());
        add("left_out", take(measured, all_but(measured.configuration_count(), known)),
            result.campaign, found);
    }
    return judged;
}

}  // namespace

Printed describe_calibration(const CalibrateArguments& arguments, const Calibration& result,
                             const io::Provenance& made_from) {
    std::string record;
    for (const auto& [key, text] : made_from.record) {
        record += fmt::format("{}{}: {}", record.empty() ? "\n" : ", ", key, text);
    }
    if (!record.empty()) record += '\n';
    return {made_from.answers,
            format(result, arguments.has_all_parameters) + describe_start(arguments) + record,
            [&] { return io::to_json(result, made_from); }};
}

io::PagePart show_estimate(const Campaign& campaign, const Estimate& estimate,
                           const Measurements* measurements) {
    io::PagePart part;
    part.title = campaign.name;
    part.scene = make_scene(campaign, estimate.parameters);
    if (measurements != nullptr) {
        part.configurations = {measurements->ids, measurements->configurations};
    }
    part.error_map = map_if_possible([&] { return map_errors(campaign, estimate); });
    return part;
}

void show_calibration(const CalibrateArguments& arguments, const CommonOptions& common,
                      const Calibration& result, const Measurements& measured,
                      const CalibrationOptions& options, io::PagePart part,
                      const Printed& printed) {
    if ((arguments.page + arguments.plot).empty()) return;
    const Measurements used = options.used.empty() ? measured : take(measured, options.used);
    const std::vector<ReadingResidual> readings = list_residuals(result, used);
    if (!arguments.page.empty()) {
        part.residuals = io::page_residuals(result.campaign, used, readings);
        part.residuals->judged = judged_residuals(result, measured, options);
        write_page(arguments.page, std::move(part), printed, common);
    }
    if (arguments.plot.empty()) return;
    draw_plot(arguments.plot, [&](const std::string& image) {
        return detail::residual_plot_script(result.campaign, readings, image);
    });
}

}  // namespace posewise::cli
