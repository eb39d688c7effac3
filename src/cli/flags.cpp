#include "flags.hpp"

#include <array>
#include <string_view>
#include <utility>

namespace posewise::cli {
namespace {

constexpr auto flags = std::to_array<std::pair<std::string_view, std::string_view>>(
    {{"augment_plan", "--augment-plan"},
     {"count", "--random"},
     {"dropped", "--drop"},
     {"earlier", "--from"},
     {"earlier.has_new_base", "--moved base"},
     {"earlier.is_prior", "--as-prior"},
     {"focus", "--focus"},
     {"folds", "--folds"},
     {"frames.seed", "--near"},
     {"held", "--augment"},
     {"holdout", "--holdout"},
     {"least_distance", "--least-distance-deg"},
     {"measured", "--measurements"},
     {"plan", "--plan"},
     {"points_unit", "--points-unit"},
     {"pool_count", "--pool"},
     {"pose_count", "--poses"},
     {"spread.is_prior", "--prior"},
     {"splits", "--splits"},
     {"starts", "--starts"},
     {"time", "--time"},
     {"workspace_box_mm", "--workspace-box-mm"}});

}  // namespace

std::string with_flags(std::string message) {
    for (const auto& [field, flag] : flags) {
        const std::string quoted = '`' + std::string(field) + '`';
        for (std::size_t at = message.find(quoted); at != std::string::npos;
             at = message.find(quoted, at + flag.size())) {
            message.replace(at, quoted.size(), flag);
        }
    }
    return message;
}

}  // namespace posewise::cli
