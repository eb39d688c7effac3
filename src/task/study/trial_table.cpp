#include "trial_table.hpp"

#include <cassert>

namespace posewise::detail {

TrialTable::TrialTable(std::shared_ptr<ScratchFile> file, std::size_t width)
    : file_(std::move(file)), width_(width) {}

bool TrialTable::has(Index number) const {
    const auto found = blocks_.find(number / block);
    return found != blocks_.end() && found->second.has[static_cast<std::size_t>(number % block)];
}

std::size_t TrialTable::place_of(Index number) const {
    const auto within = static_cast<std::size_t>(number % block);
    return blocks_.at(number / block).place + within * (1 + width_);
}

void TrialTable::put(const Trial& trial) {
    assert(trial.values.size() <= width_);
    const auto [found, is_new] = blocks_.try_emplace(trial.number / block);
    if (is_new) found->second.place = file_->add_place(block * (1 + width_));
    const std::size_t place = place_of(trial.number);
    const auto size = static_cast<double>(trial.values.size());
    file_->write(place, {&size, 1});
    file_->write(place + 1, trial.values);
    found->second.has.set(static_cast<std::size_t>(trial.number % block));
    ++count_;
}

Trial TrialTable::trial(Index number) const {
    const std::size_t place = place_of(number);
    double size = 0;
    file_->read(place, {&size, 1});
    Trial trial{number, std::vector<double>(static_cast<std::size_t>(size))};
    file_->read(place + 1, trial.values);
    return trial;
}

void TrialTable::for_each(const std::function<void(const Trial&)>& visitor) const {
    for (const auto& [number, of_block] : blocks_) {
        for (std::size_t k = 0; k < block; ++k) {
            if (of_block.has[k]) visitor(trial(number * block + static_cast<Index>(k)));
        }
    }
}

void TrialTable::read(Index number, std::size_t first, std::span<double> values) const {
    file_->read(place_of(number) + 1 + first, values);
}

void TrialTable::close_ranks() {
    Index next = 0;
    for (auto& [number, of_block] : blocks_) {  // put() makes blocks before this one only
        for (std::size_t k = 0; k < block; ++k) {
            if (!of_block.has[k]) continue;
            Trial moved = trial(number * block + static_cast<Index>(k));
            if (moved.number != next) {
                of_block.has.reset(k);
                --count_;
                moved.number = next;
                put(moved);
            }
            ++next;
        }
    }
}

}  // namespace posewise::detail
