#include "posewise/io/measurements_file.hpp"

namespace posewise::io {

Measurements read_measurements(const std::string& path, const CampaignFile& file) {
    return path.ends_with(".mat") || path.ends_with(".MAT")
               ? read_measurements_mat(path, file.campaign, file.mat)
               : read_measurements_csv(path, file.campaign);
}

}  // namespace posewise::io
