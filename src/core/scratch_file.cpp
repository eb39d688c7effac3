#include "scratch_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

std::string temporary_folder() {
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
    return error ? "/tmp" : folder.string();
}

InputError failure(const char* what) {
    return input_error_at({temporary_folder()},
                          std::string("results cannot be ") + what +
                              " there for a while: " + std::strerror(errno) +
                              "; must have room, or TMPDIR name another folder");
}

/// Calls `transfer(bytes done, bytes left)` until all are; false if it fails or there are no more.
template <typename Transfer>
bool transfer_all(std::size_t size, const Transfer& transfer) {
    for (std::size_t done = 0; done < size;) {
        const ssize_t count = transfer(done, size - done);
        if (count == 0) errno = EIO;
        if (count == 0 || (count < 0 && errno != EINTR)) return false;
        if (count > 0) done += static_cast<std::size_t>(count);
    }
    return true;
}

off_t byte_of(std::size_t place, std::size_t done) {
    return static_cast<off_t>(place * sizeof(double) + done);
}

}  // namespace

ScratchFile::ScratchFile(std::size_t in_memory) : in_memory_(in_memory) {}

ScratchFile::~ScratchFile() {
    if (file_ >= 0) ::close(file_);
}

std::size_t ScratchFile::add_place(std::size_t count) {
    const std::size_t place = size_;
    size_ += count;
    if (file_ < 0 && size_ > in_memory_) open();
    if (file_ < 0) numbers_.resize(size_);
    return place;
}

void ScratchFile::open() {
    std::string path = temporary_folder() + "/posewise.XXXXXX";
    file_ = ::mkostemp(path.data(), O_CLOEXEC);
    if (file_ < 0) throw failure("kept");
    ::unlink(path.c_str());
    write(0, numbers_);
    numbers_ = {};
}

void ScratchFile::write(std::size_t place, std::span<const double> numbers) {
    if (file_ < 0) {
        std::ranges::copy(numbers, numbers_.begin() + static_cast<std::ptrdiff_t>(place));
        return;
    }
    const auto* const bytes = reinterpret_cast<const char*>(numbers.data());
    const bool is_written = transfer_all(numbers.size_bytes(), [&](auto done, auto left) {
        return ::pwrite(file_, bytes + done, left, byte_of(place, done));
    });
    if (!is_written) throw failure("kept");
}

void ScratchFile::read(std::size_t place, std::span<double> numbers) const {
    if (file_ < 0) {
        std::copy_n(numbers_.begin() + static_cast<std::ptrdiff_t>(place), numbers.size(),
                    numbers.begin());
        return;
    }
    auto* const bytes = reinterpret_cast<char*>(numbers.data());
    const bool is_read = transfer_all(numbers.size_bytes(), [&](auto done, auto left) {
        return ::pread(file_, bytes + done, left, byte_of(place, done));
    });
    if (!is_read) throw failure("read");
}

}  // namespace posewise::detail
