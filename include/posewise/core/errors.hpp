#pragma once

#include <stdexcept>
#include <string>

namespace posewise {

/// Thrown for every input the library cannot use. The message gives the name, the value and the
/// rule it breaks; file readers put `path:line:column: ` in front.
class InputError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Position of a value in a text file. Lines and columns count from 1; 0 means "the whole file".
struct FileLocation {
    std::string path;
    long line = 0;
    long column = 0;
};

/// An InputError whose message starts with `path:line:column: `.
InputError input_error_at(const FileLocation& location, const std::string& message);

}  // namespace posewise
