#include "writer_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// The one who had the lock may have removed its file before we locked that.
bool is_removed(int fd, const std::string& name) {
    struct stat locked {};
    struct stat named {};
    return ::fstat(fd, &locked) != 0 || ::stat(name.c_str(), &named) != 0 ||
           locked.st_ino != named.st_ino || locked.st_dev != named.st_dev;
}

}  // namespace

WriterLock::WriterLock(const std::string& file, const std::string& path) : name_(file + "-lock") {
    do {
        if (fd_ >= 0) ::close(fd_);
        fd_ = ::open(name_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (fd_ < 0) {
            throw input_error_at({path}, std::string("cannot be written: ") + std::strerror(errno));
        }
        if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
            const int problem = errno;
            ::close(fd_);
            if (problem != EWOULDBLOCK) {
                throw input_error_at({path},
                                     std::string("cannot be locked: ") + std::strerror(problem));
            }
            throw input_error_at({path},
                                 "is being written by another process; each must have a "
                                 "store of its own, to be joined by --merge");
        }
    } while (is_removed(fd_, name_));
}

WriterLock::~WriterLock() {
    ::unlink(name_.c_str());
    ::close(fd_);
}

}  // namespace posewise::detail
