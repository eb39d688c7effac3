#include "files.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "io/format/atomic_file.hpp"
#include "io/format/text.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::cli {
namespace {

namespace fs = std::filesystem;

/// A device or pipe: nothing that is replaced.
bool is_special(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::exists(status) && !fs::is_regular_file(status);
}

/// Whether that is where standard output goes, too: a pipe, a file or a terminal.
bool is_standard_output(const std::string& path) {
    struct stat here {};
    struct stat out {};
    return ::stat(path.c_str(), &here) == 0 && ::fstat(STDOUT_FILENO, &out) == 0 &&
           here.st_dev == out.st_dev && here.st_ino == out.st_ino &&
           (!S_ISCHR(out.st_mode) || isatty(STDOUT_FILENO) == 1);
}

/// Whole, and where writing to it would lead, that of a dangling link, too.
fs::path follow_links(const std::string& path) {
    const std::string target = detail::follow_link(path);
    std::error_code error;
    fs::path whole = fs::weakly_canonical(fs::absolute(target, error), error);
    return error ? fs::path(target) : whole;
}

bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    if (fs::equivalent(a, b, error) && !error) return true;
    return follow_links(a) == follow_links(b);
}

/// What SQLite keeps beside a store of trials may hold the latest of them.
void check_beside_stores(const std::string& path, const std::vector<std::string>& inputs) {
    const std::string file = follow_links(path).string();
    for (const std::string_view end : {"-wal", "-shm", "-lock"}) {
        if (!file.ends_with(end)) continue;
        const std::string store = file.substr(0, file.size() - end.size());
        const bool is_used = std::ranges::any_of(inputs, [&](const std::string& input) {
            return !input.empty() && is_same_file(store, input);
        });
        if (!is_used && !io::is_trial_store(store)) continue;
        throw input_error_at({path}, "belongs to a store of trials; must be another file");
    }
}

void check_folder(const std::string& path) {
    fs::path folder = follow_links(path).parent_path();
    if (folder.empty()) folder = ".";
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        throw input_error_at({path}, std::string("cannot be written: ") + std::strerror(errno));
    }
}

}  // namespace

namespace {

/// A plan or an estimate holds the names of the files that it was made from.
void check_names(const std::vector<std::string>& inputs) {
    for (const std::string& input : inputs) {
        if (detail::find_not_utf8(input) == std::string::npos) continue;
        throw input_error_at({input},
                             "its name is not UTF-8, and would stand in the file written; must be "
                             "UTF-8 (or plain ASCII)");
    }
}

}  // namespace

void check_outputs(const std::vector<const io::CampaignFile*>& campaigns,
                   std::vector<std::string> inputs, const std::vector<std::string>& outputs,
                   const CommonOptions& common) {
    for (const io::CampaignFile* const campaign : campaigns) {
        if (campaign == nullptr) continue;
        inputs.push_back(campaign->path);
        if (campaign->urdf) inputs.push_back(campaign->urdf->path);
    }
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const std::string& path = outputs[i];
        std::error_code ignored;
        if (fs::is_directory(path, ignored)) {
            throw input_error_at({path}, "is a folder; must be the name of a file");
        }
        if (path.empty()) continue;
        if (path.ends_with(".json")) check_names(inputs);
        if (common.json && is_standard_output(path)) {
            throw input_error_at(
                {path}, "is standard output, which with --json holds one document; must be a file");
        }
        if (is_special(path)) continue;
        for (const std::string& input : inputs) {
            if (!input.empty() && is_same_file(path, input)) {
                throw input_error_at({path}, "is read and shall be written; must be another file");
            }
        }
        check_beside_stores(path, inputs);
        for (std::size_t k = 0; k < i; ++k) {
            if (!outputs[k].empty() && is_same_file(path, outputs[k])) {
                throw input_error_at({path}, "shall be written twice; must be two files");
            }
        }
        check_folder(path);
    }
}

}  // namespace posewise::cli
