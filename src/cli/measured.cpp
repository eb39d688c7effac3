#include "measured.hpp"

#include "common.hpp"
#include "files.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {

io::CampaignFile read_with_prior(const std::string& path, std::optional<bool> prior) {
    io::CampaignFile file = io::read_campaign(path);
    io::set_prior(file, prior.value_or(file.spread.is_prior));
    return file;
}

std::string describe_planned(const io::CampaignFile& campaign, double repeats) {
    std::string text = detail::describe_scaling(campaign, repeats);
    if (campaign.planned_model) {
        text += "errors: " + std::string(io::error_model_name(*campaign.planned_model)) +
                ", as planning.errors says; calibrate fits those of robot.errors\n";
    }
    return text;
}

Measurements read_measured(const std::string& path, const io::CampaignFile& file) {
    Measurements measured = io::read_measurements(path, file);
    if (const auto beyond = find_beyond_limits(file, measured)) {
        print_warning(path + ": " + describe(*beyond, measured));
    }
    return measured;
}

}  // namespace posewise::cli
