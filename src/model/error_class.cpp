#include "error_class.hpp"

namespace posewise::detail {

ErrorClass error_class_of(const Chain& robot, Index parameter) {
    const Element& element = robot.parameter_element(parameter);
    const bool turns = element.motion == Motion::Rotation;
    if (const ErrorTerm* const term = robot.parameter_term(parameter)) {
        switch (term->kind) {
            case TermKind::Gravity:
                return ErrorClass::Gravity;
            case TermKind::Torque:
                return ErrorClass::Torque;
            case TermKind::Harmonic:
                return turns ? ErrorClass::Harmonic : ErrorClass::SlideHarmonic;
            case TermKind::Tilt:
                return ErrorClass::Tilt;
            case TermKind::Gain:
                return ErrorClass::Gain;
            case TermKind::Free:
                return ErrorClass::Other;
        }
    }
    if (element.joints.empty()) return turns ? ErrorClass::Angle : ErrorClass::Length;
    return turns ? ErrorClass::Offset : ErrorClass::Slide;
}

}  // namespace posewise::detail
