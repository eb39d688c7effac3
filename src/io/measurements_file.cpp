#include "posewise/io/measurements_file.hpp"

namespace posewise::io {
namespace {

bool is_matlab(const std::string& path) { return path.ends_with(".mat") || path.ends_with(".MAT"); }

}  // namespace

Measurements read_measurements(const std::string& path, const CampaignFile& file) {
    return is_matlab(path) ? read_measurements_mat(path, file.campaign, file.mat)
                           : read_measurements_csv(path, file.campaign);
}

Configurations read_configurations(const std::string& path, const CampaignFile& file) {
    if (!is_matlab(path)) return read_configurations_csv(path, file.campaign);
    Measurements read = read_measurements_mat(path, file.campaign, file.mat);
    const Index count = read.configuration_count();
    return {std::move(read.ids), std::move(read.configurations),
            RowArrayXb::Constant(count, file.campaign.sensor->target_count(), true)};
}

}  // namespace posewise::io
