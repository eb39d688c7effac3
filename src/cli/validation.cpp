#include "validation.hpp"

#include <fmt/format.h>

#include "common.hpp"
#include "files.hpp"
#include "io/campaign/robot_statement.hpp"
#include "measured.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::cli {

Validation read_validation(const CalibrateArguments& arguments, const io::CampaignFile& file,
                           const io::PointsSource& points) {
    Validation validation;
    if (!arguments.validation_campaign.empty()) {
        validation.campaign = read_with_prior(arguments.validation_campaign, arguments.prior);
        detail::check_is_same_robot(validation.campaign->path, validation.campaign->robot,
                                    file.robot);
    }
    if (arguments.validate.empty()) return validation;
    const io::MeasurementsFile read = read_measured(
        arguments.validate, validation.campaign ? *validation.campaign : file, points);
    validation.measured = read;
    validation.is_joined = read.is_joined;
    return validation;
}

void warn_of_no_validation(const CalibrateArguments& arguments, const Validation& validation,
                           const io::Provenance& made_from) {
    if (!validation.measured) return;
    const EarlierArguments& earlier = arguments.earlier;
    const bool is_of_earlier =
        earlier.builds_on() && io::is_made_from(earlier.from, *validation.measured);
    if (!is_of_earlier && !io::are_of_checksum(made_from.measurements_checksum,
                                               *validation.measured, arguments.options.excluded)) {
        return;
    }
    print_warning(fmt::format("{}: {} from these very measurements; to validate takes others",
                              arguments.validate,
                              is_of_earlier ? earlier.from + " was made" : "it is calibrated"));
}

void use_plan(const std::string& path, const Plan& plan, const Campaign& campaign,
              const io::MeasurementsFile& measured, CalibrationOptions& options) {
    const auto left_out = leave_out_missing(path, plan, measured, options.excluded);
    compute_from(path, [&] {
        options.used = posewise::find_planned(plan, campaign, measured, left_out);
        options.verification = find_verification(plan, campaign, measured, options.excluded);
    });
}

void check_limit(const CalibrateArguments& arguments, const Campaign& campaign,
                 const Measurements& measured, const CalibrationOptions& options) {
    if (!arguments.limit_mm) return;
    if (!campaign.sensor->has_lengths()) {
        throw input_error_at({arguments.paths.campaign},
                             "the sensor measures no length, so that --limit-mm has no meaning");
    }
    const bool has_others =
        !options.used.empty() && std::ssize(options.used) < measured.configuration_count();
    if (options.validation != nullptr || has_others) return;
    throw input_error_at({arguments.paths.measurements},
                         "--limit-mm needs poses that are not calibrated with: --validate, or "
                         "--plan with a plan that has some to verify or leaves some out");
}

}  // namespace posewise::cli
