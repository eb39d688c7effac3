#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "posewise/core/errors.hpp"

namespace posewise::testing {

/// An empty folder of its own, gone with all it holds at the end of the test.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "posewise.XXXXXX").string();
        if (::mkdtemp(pattern.data()) == nullptr) std::abort();
        path_ = pattern;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    std::string path(const std::string& name) const { return (path_ / name).string(); }

    /// Writes a file and gives its path.
    std::string write(const std::string& name, const std::string& content) const {
        std::ofstream(path(name), std::ios::binary) << content;
        return path(name);
    }

    std::size_t file_count() const {
        const std::filesystem::directory_iterator files(path_);
        return static_cast<std::size_t>(std::distance(begin(files), end(files)));
    }

  private:
    std::filesystem::path path_;
};

/// The message of the InputError that `action` throws, from the file's name on (the folder left
/// out); "no error" if it throws none.
template <class Action>
std::string input_error_of(Action&& action) {
    try {
        action();
    } catch (const InputError& error) {
        std::string message = error.what();
        const auto name = message.find("posewise.");
        const auto slash = name == std::string::npos ? name : message.find('/', name);
        return slash == std::string::npos ? message : message.substr(slash + 1);
    }
    return "no error";
}

}  // namespace posewise::testing
