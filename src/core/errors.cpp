#include "posewise/core/errors.hpp"

namespace posewise {

InputError input_error_at(const FileLocation& location, const std::string& message) {
    std::string text = location.path;
    if (location.line > 0) {
        text += ':' + std::to_string(location.line);
        if (location.column > 0) text += ':' + std::to_string(location.column);
    }
    return InputError(text + ": " + message);
}

}  // namespace posewise
