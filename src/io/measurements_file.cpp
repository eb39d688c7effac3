#include "posewise/io/measurements_file.hpp"

#include "../core/text.hpp"
#include "../model/joint_limits.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::io {
namespace {

bool is_matlab(const std::string& path) { return path.ends_with(".mat") || path.ends_with(".MAT"); }

}  // namespace

Measurements read_measurements(const std::string& path, const CampaignFile& file) {
    return is_matlab(path) ? read_measurements_mat(path, file, file.mat)
                           : read_measurements_csv(path, file);
}

Configurations read_any_configurations(const std::string& path, const CampaignFile& file) {
    if (!is_matlab(path)) return read_configurations_csv(path, file);
    Measurements read = read_measurements_mat(path, file, file.mat);
    const Index count = read.configuration_count();
    return {std::move(read.ids), std::move(read.configurations),
            all_seen(count, file.sensor->target_count())};
}

Configurations read_configurations(const std::string& path, const CampaignFile& file) {
    Configurations read = read_any_configurations(path, file);
    for (Index i = 0; i < read.joints.rows(); ++i) {
        const std::string violation =
            detail::describe_limit_violation(file.robot, read.joints.row(i).transpose());
        if (violation.empty()) continue;
        throw input_error_at({path}, "configuration " +
                                         detail::quote(read.ids[static_cast<std::size_t>(i)]) +
                                         " is beyond the joint limits: " + violation);
    }
    return read;
}

}  // namespace posewise::io
