#pragma once

#include <span>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Numbers that need not stay in memory: the first ones do, more are in a file of the folder for
/// temporary files (TMPDIR, else /tmp) that has no name and is gone with this, however it ends.
class ScratchFile {
  public:
    /// With so many numbers in memory.
    explicit ScratchFile(std::size_t in_memory = std::size_t{1} << 20);
    ~ScratchFile();
    ScratchFile(const ScratchFile&) = delete;
    ScratchFile& operator=(const ScratchFile&) = delete;

    /// Where so many more numbers have a place; they must be written before they are read.
    std::size_t add_place(std::size_t count);

    /// Numbers at a place, or from within one on. Throws InputError if the file cannot be made,
    /// written (a full disk) or read.
    void write(std::size_t place, std::span<const double> numbers);
    void read(std::size_t place, std::span<double> numbers) const;

  private:
    void open();

    std::size_t in_memory_;
    std::size_t size_ = 0;
    std::vector<double> numbers_;  // all of them while there is no file
    int file_ = -1;
};

}  // namespace posewise::detail
