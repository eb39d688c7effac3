#include "measured.hpp"

#include "common.hpp"
#include "files.hpp"
#include "posewise/report/reports.hpp"

namespace posewise::cli {

Measurements read_measured(const std::string& path, const io::CampaignFile& file) {
    Measurements measured = io::read_measurements(path, file);
    if (const auto beyond = find_beyond_limits(file, measured)) {
        print_warning(path + ": " + describe(*beyond, measured));
    }
    return measured;
}

void check_is_of_robot(const Campaign& campaign, const Measurements& measured,
                       const std::string& path) {
    compute_from(path, [&] {
        posewise::check_is_of_robot(campaign, measured,
                                    register_base_and_targets(campaign, measured));
    });
}

}  // namespace posewise::cli
