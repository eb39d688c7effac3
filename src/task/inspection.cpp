#include "posewise/task/inspection.hpp"

#include "../model/complete_model.hpp"
#include "posewise/calibrator/registration.hpp"

namespace posewise {

Inspection inspect(const Campaign& campaign, const Chain& declared, bool is_stated) {
    Inspection inspection;
    inspection.campaign = campaign;
    inspection.complete = with_robot(campaign, detail::complete_model(declared));
    if (is_stated) inspection.stated = find_identifiable(campaign);
    inspection.of_complete = find_identifiable(inspection.complete);
    inspection.least_pose_count = least_calibration_count(campaign);
    return inspection;
}

std::vector<std::string> find_doubtful_parameters(const Inspection& inspection) {
    const bool is_stated = inspection.stated.has_value();
    const Campaign& campaign = is_stated ? inspection.campaign : inspection.complete;
    const Identifiability& found = is_stated ? *inspection.stated : inspection.of_complete;
    std::vector<std::string> weakest;
    if (campaign.spread.is_prior || has_clear_gap(found)) return weakest;
    const auto names = parameter_names(campaign);
    for (const Index k : weakest_kept(campaign, found)) {
        weakest.push_back(names[static_cast<std::size_t>(k)]);
    }
    return weakest;
}

}  // namespace posewise
