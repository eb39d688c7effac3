#include "atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>

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

    bool write(const std::string& content) const {
        std::size_t done = 0;
        while (done < content.size()) {
            const ssize_t count = ::write(fd_, content.data() + done, content.size() - done);
            if (count < 0 && errno != EINTR) return false;
            if (count > 0) done += static_cast<std::size_t>(count);
        }
        return true;
    }

    bool sync() const { return ::fsync(fd_) == 0; }

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

/// While one lives, signals that end a program wait, so that no temporary file is left behind. Not
/// by a mask, which holds for one thread only: another one would take the signal.
class SignalDelay {
  public:
    SignalDelay() : lock_(mutex_) {
        struct sigaction delay {};
        delay.sa_handler = note;
        delay.sa_flags = SA_RESTART;
        for (std::size_t k = 0; k < signals.size(); ++k) {
            has_come_[k] = false;
            ::sigaction(signals[k], nullptr, &before_[k]);
            if (before_[k].sa_handler != SIG_IGN) ::sigaction(signals[k], &delay, nullptr);
        }
    }
    ~SignalDelay() {
        for (std::size_t k = 0; k < signals.size(); ++k) {
            ::sigaction(signals[k], &before_[k], nullptr);
        }
        for (std::size_t k = 0; k < signals.size(); ++k) {
            if (has_come_[k]) ::raise(signals[k]);
        }
    }
    SignalDelay(const SignalDelay&) = delete;
    SignalDelay& operator=(const SignalDelay&) = delete;

  private:
    static constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};

    static void note(int signal) {
        for (std::size_t k = 0; k < signals.size(); ++k) {
            if (signals[k] == signal) has_come_[k] = true;
        }
    }

    static inline std::mutex mutex_;  // what is done with a signal is of the whole program
    static inline std::array<std::atomic<bool>, signals.size()> has_come_{};
    static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

    std::lock_guard<std::mutex> lock_;
    std::array<struct sigaction, signals.size()> before_{};
};

/// A file beside the one to write, under a name that no other writer uses (short, since the file's
/// own may be as long as names can be); removed unless it was renamed.
class Temporary {
  public:
    explicit Temporary(const std::string& path) {
        static std::atomic<unsigned> count{0};
        const std::string name =
            ".posewise." + std::to_string(::getpid()) + "." + std::to_string(count++) + ".tmp";
        name_ = (fs::path(path).parent_path() / name).string();
    }
    ~Temporary() {
        if (exists_) ::unlink(name_.c_str());
    }
    Temporary(const Temporary&) = delete;
    Temporary& operator=(const Temporary&) = delete;

    const std::string& name() const { return name_; }

    bool write(const std::string& content) {
        const FileDescriptor file(name_, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC);
        exists_ = file.is_open();
        return exists_ && file.write(content) && file.sync();
    }

    bool rename_to(const std::string& path) {
        exists_ = ::rename(name_.c_str(), path.c_str()) != 0;
        return !exists_;
    }

  private:
    std::string name_;
    bool exists_ = false;
};

/// Where a path leads: a link is followed, so that the file it names is replaced, not the link.
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

}  // namespace

void write_file(const std::string& path, const std::string& content) {
    write_file(path, content, {});
}

void write_file(const std::string& path, const std::string& content,
                const std::function<void(const std::string& temporary)>& check) {
    const std::string target = follow_link(path);
    std::error_code error;
    const fs::file_status status = fs::status(target, error);
    if (fs::is_directory(status)) {
        throw input_error_at({path}, "is a directory; must be the name of a file to write");
    }
    if (fs::exists(status) && !fs::is_regular_file(status)) {  // a pipe or device: not replaceable
        if (check) throw input_error_at({path}, "cannot be read back; must be a file");
        const FileDescriptor file(target, O_WRONLY | O_CLOEXEC);
        if (!file.is_open() || !file.write(content)) throw failure(path, "cannot be written");
        return;
    }
    const SignalDelay delay;
    Temporary temporary(target);
    if (!temporary.write(content)) throw failure(path, "cannot be written");
    if (check) check(temporary.name());
    if (!temporary.rename_to(target)) throw failure(path, "cannot be replaced");
}

std::string read_file(const std::string& path, std::size_t most) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
        throw input_error_at({path}, "is a directory; must be a file");
    }
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
