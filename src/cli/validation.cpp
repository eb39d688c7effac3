#include "validation.hpp"

#include <fmt/format.h>

#include "../io/robot_statement.hpp"
#include "common.hpp"
#include "measured.hpp"

namespace posewise::cli {

Validation read_validation(const CalibrateArguments& arguments, const io::CampaignFile& file) {
    Validation validation;
    if (!arguments.validation_campaign.empty()) {
        validation.campaign = read_with_prior(arguments.validation_campaign, arguments.prior);
        detail::check_is_same_robot(validation.campaign->path, validation.campaign->robot,
                                    file.robot);
    }
    if (arguments.validate.empty()) return validation;
    validation.measured =
        read_measured(arguments.validate, validation.campaign ? *validation.campaign : file);
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

}  // namespace posewise::cli
