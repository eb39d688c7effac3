#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>

#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "posewise/io/measurements_file.hpp"

namespace posewise::io {

void write_corrections_csv(const std::string& path, const Campaign& campaign,
                           const std::vector<std::string>& ids,
                           const std::vector<Correction>& corrections,
                           const std::vector<std::string>& purposes) {
    const bool has_purpose = !purposes.empty();
    std::string text =
        fmt::format("config{},{}{}{}\n", detail::joint_header(campaign),
                    fmt::join(detail::correction_columns, ","), has_purpose ? "," : "",
                    has_purpose ? detail::purpose_column : "");
    for (std::size_t i = 0; i < corrections.size(); ++i) {
        const Correction& correction = corrections[i];
        fmt::format_to(std::back_inserter(text), "{}{},{:.6f},{:.6f},{:.6f},{:.6f},{}{}\n",
                       detail::csv_field(ids[i]), detail::joint_cells(campaign, correction.joints),
                       1e3 * correction.residual.position, 1e3 * correction.residual.orientation,
                       1e3 * correction.uncorrected.position,
                       1e3 * correction.uncorrected.orientation,
                       detail::csv_field(describe_shortfall(campaign.robot, correction)),
                       has_purpose ? ',' + purposes[i] : "");
    }
    detail::write_file(path, text);
}

}  // namespace posewise::io
