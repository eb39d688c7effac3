#pragma once

#include <bitset>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/scratch_file.hpp"
#include "posewise/task/study.hpp"

namespace posewise::detail {

/// Finished trials of one series by number, of which there may be millions: they take a bit of
/// memory each.
class TrialTable {
  public:
    /// For trials of at most `width` numbers, in a file that other tables may use, too.
    TrialTable(std::shared_ptr<ScratchFile> file, std::size_t width);

    Index count() const { return count_; }
    bool has(Index number) const;

    /// One that is not there yet.
    void put(const Trial& trial);

    /// In the order of their numbers.
    void for_each(const std::function<void(const Trial&)>& visitor) const;

    /// Numbers of a trial that is there, from its number `first` on.
    void read(Index number, std::size_t first, std::span<double> values) const;

    /// Gives the trials the numbers 0, 1, ..., in their order.
    void close_ranks();

  private:
    static constexpr Index block = 256;
    struct Block {
        std::size_t place = 0;  ///< of `block` trials, each its size and then its numbers
        std::bitset<block> has;
    };

    /// Where the trial is or will be.
    std::size_t place_of(Index number) const;
    Trial trial(Index number) const;

    std::shared_ptr<ScratchFile> file_;
    std::size_t width_;
    Index count_ = 0;
    std::map<Index, Block> blocks_;  // number b has the trials from b * block on
};

}  // namespace posewise::detail
