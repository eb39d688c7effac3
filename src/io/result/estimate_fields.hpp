#pragma once

#include <string>
#include <vector>

#include "io/format/fields.hpp"
#include "io/format/units.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/io/result_files.hpp"

/// Fields of estimate files that are read again.
namespace posewise::detail {

/// A number in m or rad, of a size that occurs.
struct Size {
    bool is_angle = false;
    double least = -std::numeric_limits<double>::infinity();

    void read(const JsonValue& json, double& value) const;
};

/// What it was made from; what is not known is left out.
void provenance_fields(const Fields& file, io::Provenance& made_from);

/// How the identification ended, what is wrong with it, and how well the model fits.
void fit_fields(const Fields& file, Estimate& estimate, std::vector<std::string>& faults);

}  // namespace posewise::detail
