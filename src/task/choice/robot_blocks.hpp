#pragma once

#include <vector>

#include "posewise/task/planning.hpp"

namespace posewise::detail {

/// By how many standard deviations the logarithms of a robot's factors are off.
struct RobotSizes {
    double errors = 0;
    double model_error = 0;
};

/// What comes of some robots, m.
struct FoundRange {
    double expected = 0, lower = 0, upper = 0, assured = 0;
};

/// Half a unit of the last of so many significant digits; 0 if the number is not positive.
double numerical_tolerance(double number, Index digits);

/// Robots in blocks, of which each has some of any size and, where these differ and the RMS is
/// asked for, some of expected size.
class RobotBlocks {
  public:
    static constexpr Index least = 10;  ///< before they tell how sure their average is

    RobotBlocks(const KnownWithin& known, const SimulatedPlanOptions& options);

    Index robots_a_block() const { return any_ + expected_; }
    Index count() const { return static_cast<Index>(ranges_.size()); }
    Index most() const { return most_; }
    Index any_count() const { return any_ * count(); }
    Index expected_count() const { return expected_ * count(); }
    Index uncalibrated_count() const;

    /// Of robot k of block b: those of any size fill the block evenly.
    RobotSizes sizes(Index b, Index k) const;

    /// The quantity of each robot of a block; infinity: it was not calibrated.
    void add(const VectorXd& values);

    /// Of all robots; there must be a block.
    FoundRange found() const;
    /// Standard deviation of an average over the blocks; infinity: unknown.
    double uncertainty(double FoundRange::*number) const;
    /// Twice the largest of them.
    double doubt() const;
    /// Over the robots of any size that were calibrated.
    double deviation() const;
    /// How many blocks there will have to be, as far as can be told.
    Index needed(double tolerance) const;

  private:
    FoundRange range_of(const VectorXd& any, const VectorXd& of_expected_size) const;

    ErrorQuantity quantity_;
    double assurance_;
    std::uint64_t seed_;
    Index any_;       ///< in a block
    Index expected_;  ///< besides
    Index most_;
    std::vector<double> any_values_;
    std::vector<double> expected_values_;
    std::vector<FoundRange> ranges_;  ///< of each block
};

}  // namespace posewise::detail
