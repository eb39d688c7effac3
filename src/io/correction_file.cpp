#include "posewise/io/correction_file.hpp"

#include <fmt/format.h>

#include <iterator>

#include "csv_reader.hpp"
#include "measurement_columns.hpp"
#include "posewise/io/atomic_file.hpp"

namespace posewise::io {

void write_corrections_csv(const std::string& path, const Campaign& campaign,
                           const std::vector<std::string>& ids,
                           const std::vector<Correction>& corrections) {
    std::string text = "config" + joint_header(campaign) +
                       ",residual_mm,residual_mrad,uncorrected_mm,uncorrected_mrad,note\n";
    for (std::size_t i = 0; i < corrections.size(); ++i) {
        const Correction& correction = corrections[i];
        fmt::format_to(std::back_inserter(text), "{}{},{:.6f},{:.6f},{:.6f},{:.6f},{}\n",
                       csv_field(ids[i]), joint_cells(campaign, correction.joints),
                       1e3 * correction.residual.position, 1e3 * correction.residual.orientation,
                       1e3 * correction.uncorrected.position,
                       1e3 * correction.uncorrected.orientation,
                       csv_field(describe_shortfall(campaign.robot, correction)));
    }
    write_file(path, text);
}

}  // namespace posewise::io
