#include "posewise/task/calibration.hpp"

namespace posewise {

std::string_view method_name(CalibrationMethod method) {
    switch (method) {
        case CalibrationMethod::Joint:
            return "lm";
        case CalibrationMethod::TwoStep:
            return "two-step";
        case CalibrationMethod::Global:
            return "global";
    }
    return "";
}

Index default_folds(Index configuration_count) {
    constexpr Index leave_one_out_limit = 100;
    constexpr Index folds = 10;
    if (configuration_count < 2) return 0;
    return configuration_count <= leave_one_out_limit ? configuration_count : folds;
}

}  // namespace posewise
