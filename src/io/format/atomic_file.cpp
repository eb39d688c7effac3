#include "atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include "io/measurements/signal_delay.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

namespace fs = std::filesystem;

InputError failure(const std::string& path, const std::string& what) {
    return input_error_at({path}, what + ": " + std::strerror(errno));
}

/// An open file that is closed again whatever happens.
class FileDescriptor {
  public:
    FileDescriptor(const std::string& path, int flags) : fd_(::open(path.c_str(), flags, 0666)) {}
    ~FileDescriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;

    bool is_open() const { return fd_ >= 0; }

    bool write(std::string_view content) const {
        std::size_t done = 0;
        while (done < content.size()) {
            const ssize_t count = ::write(fd_, content.data() + done, content.size() - done);
            if (count < 0 && errno != EINTR) return false;
            if (count > 0) done += static_cast<std::size_t>(count);
        }
        return true;
    }

    /// Throws InputError about the file of that name if it cannot.
    void write(const FileContent& file) const {
        const auto write_part = [&](std::string_view part) {
            if (!write(part)) throw failure(file.path, "cannot be written");
        };
        write_part(file.content);
        if (file.more) file.more(write_part);
    }

    bool sync() const { return ::fsync(fd_) == 0; }

    /// Takes over who may do what with a file; whose it is as far as the user may say so.
    bool take_permissions(const std::string& path) const {
        struct stat before {};
        if (::stat(path.c_str(), &before) != 0) return true;  // there is none
        [[maybe_unused]] const int ignored = ::fchown(fd_, before.st_uid, before.st_gid);
        return ::fchmod(fd_, before.st_mode & 0777) == 0;
    }

    /// Reads to the end, or until there is more than `most`.
    bool read(std::string& content, std::size_t most) const {
        char buffer[1 << 16];
        while (content.size() <= most) {
            const ssize_t count = ::read(fd_, buffer, sizeof buffer);
            if (count == 0) return true;
            if (count < 0 && errno != EINTR) return false;
            if (count > 0) content.append(buffer, static_cast<std::size_t>(count));
        }
        return true;
    }

  private:
    int fd_;
};

/// A name beside the file that no other writer uses; short, since the file's own may be as long as
/// names can be.
std::string temporary_name(const std::string& path) {
    static std::atomic<unsigned> count{0};
    const std::string name =
        ".posewise." + std::to_string(::getpid()) + "." + std::to_string(count++) + ".tmp";
    return (fs::path(path).parent_path() / name).string();
}

/// A file on its way to its place: written beside it and, unless it is put there, gone again.
class PendingFile {
  public:
    PendingFile(const FileContent& file) : path_(file.path), target_(follow_link(file.path)) {
        if (path_ == "-") {
            throw InputError("-: is no name of a file; /dev/stdout is standard output");
        }
        open();
        try {
            file_->write(file);
            if (!file_->take_permissions(target_) || !file_->sync()) {
                throw failure(path_, "cannot be written");
            }
        } catch (...) {
            ::unlink(temporary_.c_str());
            throw;
        }
    }
    ~PendingFile() {
        if (!is_placed_) ::unlink(temporary_.c_str());
        if (has_backup_) ::unlink(backup().c_str());
    }
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;

    const std::string& temporary() const { return temporary_; }

    void place() {
        has_backup_ = ::link(target_.c_str(), backup().c_str()) == 0;
        is_new_ = !has_backup_ && errno == ENOENT;
        if (::rename(temporary_.c_str(), target_.c_str()) != 0) {
            throw failure(path_, "cannot be replaced");
        }
        is_placed_ = true;
    }

    /// What was there is there again.
    void take_back() {
        if (!is_placed_) return;
        if (is_new_) ::unlink(target_.c_str());
        if (has_backup_ && ::rename(backup().c_str(), target_.c_str()) == 0) has_backup_ = false;
    }

  private:
    /// Under a name that is free: in containers every program is process 1.
    void open() {
        constexpr int most_tries = 10000;
        for (int k = 0; k < most_tries; ++k) {
            temporary_ = temporary_name(target_);
            file_.emplace(temporary_, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC);
            if (file_->is_open()) return;
            if (errno != EEXIST) break;
        }
        throw failure(path_, "cannot be written");
    }

    std::string backup() const { return temporary_ + '~'; }

    std::string path_;
    std::string target_;
    std::string temporary_;
    std::optional<FileDescriptor> file_;
    bool is_placed_ = false;
    bool has_backup_ = false;
    bool is_new_ = false;
};

/// Not replaceable: a pipe or device.
bool is_special(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(follow_link(path), error);
    if (fs::is_directory(status)) {
        throw input_error_at({path}, "is a directory; must be the name of a file to write");
    }
    return fs::exists(status) && !fs::is_regular_file(status);
}

/// All or none of those that can be replaced; adds the others to `special`.
void replace(const std::vector<FileContent>& files, std::vector<const FileContent*>& special) {
    const SignalDelay delay;
    std::vector<std::unique_ptr<PendingFile>> pending;
    for (const FileContent& file : files) {
        if (is_special(file.path)) {
            if (file.check)
                throw input_error_at({file.path}, "cannot be read back; must be a file");
            special.push_back(&file);
        } else {
            pending.push_back(std::make_unique<PendingFile>(file));
            if (file.check) file.check(pending.back()->temporary());
        }
    }
    try {
        for (const auto& file : pending) file->place();
    } catch (const InputError&) {
        for (const auto& file : pending) file->take_back();
        throw;
    }
}

}  // namespace

std::string follow_link(const std::string& path) {
    std::error_code error;
    if (!fs::is_symlink(path, error)) return path;
    const fs::file_status status = fs::status(path, error);
    if (fs::exists(status)) {
        const fs::path whole = fs::canonical(path, error);
        return error ? path : whole.string();  // "pipe:[...]" is no place
    }
    if (status.type() != fs::file_type::not_found) {
        throw input_error_at({path}, "is a link that leads nowhere: " + error.message());
    }
    return follow_link((fs::path(path).parent_path() / fs::read_symlink(path)).string());
}

void write_files(const std::vector<FileContent>& files) {
    std::vector<const FileContent*> special;
    replace(files, special);
    // Here a signal ends the program at once: a pipe may have no reader for ever.
    for (const FileContent* const file : special) {
        const FileDescriptor descriptor(follow_link(file->path), O_WRONLY | O_CLOEXEC);
        if (!descriptor.is_open()) throw failure(file->path, "cannot be written");
        descriptor.write(*file);
    }
}

void write_file(const std::string& path, const std::string& content, const FileCheck& check) {
    write_files({{path, content, check}});
}

std::string read_file(const std::string& path, std::size_t most) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
        throw input_error_at({path}, "is a directory; must be a file");
    }
    constexpr std::size_t most_of_device = std::size_t{1} << 20;  // /dev/zero never ends
    if (fs::is_character_file(path, error)) most = std::min(most, most_of_device);
    const FileDescriptor file(path, O_RDONLY | O_CLOEXEC);
    std::string content;
    if (!file.is_open() || !file.read(content, most)) throw failure(path, "cannot be read");
    if (content.size() > most) {
        throw input_error_at(
            {path}, "is larger than " + std::to_string(most >> 20) + " MiB; must be smaller");
    }
    return content;
}

}  // namespace posewise::detail
