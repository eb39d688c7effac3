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

}  // namespace posewise::cli
