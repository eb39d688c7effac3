#include "robot_blocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/statistics.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {
namespace {

constexpr double unknown = std::numeric_limits<double>::infinity();

/// So many that some are beyond the rarest quantile.
Index block_size(double assurance, Index most_robots) {
    constexpr double beyond = 5;
    const double rarest = std::min({0.05, assurance, 1 - assurance});
    return std::min(static_cast<Index>(std::ceil(beyond / rarest - 1e-9)),
                    most_robots / RobotBlocks::least);
}

bool sizes_differ(const KnownWithin& known) {
    return known.model_error != 1 || known.error_size != 1;
}

void append(std::vector<double>& values, const VectorXd& more) {
    values.insert(values.end(), more.begin(), more.end());
}

VectorXd vector_of(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()));
}

}  // namespace

double numerical_tolerance(double number, Index digits) {
    if (!(number > 0) || !std::isfinite(number)) return 0;
    const double last = std::floor(std::log10(number)) - static_cast<double>(digits - 1);
    return std::pow(10, last) / 2;
}

RobotBlocks::RobotBlocks(const KnownWithin& known, const SimulatedPlanOptions& options)
    : quantity_(options.quantity),
      assurance_(options.assurance),
      seed_(options.seed),
      any_(block_size(options.assurance, options.most_robots)),
      expected_(quantity_ == ErrorQuantity::Rms && sizes_differ(known) ? any_ / 4 : 0),
      most_(options.most_robots / any_) {}

RobotSizes RobotBlocks::sizes(Index b, Index k) const {
    if (k >= any_) return {};
    // A Kronecker sequence, shifted by a stream that no robot draws from.
    RandomStream stream(~seed_, static_cast<std::uint64_t>(b));
    constexpr double golden = 0.6180339887498949;
    const auto take = [&](double step) {
        const double x = static_cast<double>(k) * step + stream.uniform();
        return normal_quantile(std::clamp(x - std::floor(x), 1e-12, 1 - 1e-12));
    };
    RobotSizes drawn;
    drawn.model_error = take(1 / static_cast<double>(any_));
    drawn.errors = take(golden);
    return drawn;
}

void RobotBlocks::add(const VectorXd& values) {
    append(any_values_, values.head(any_));
    append(expected_values_, values.tail(expected_));
    ranges_.push_back(range_of(values.head(any_), values.tail(expected_)));
}

FoundRange RobotBlocks::found() const {
    return range_of(vector_of(any_values_), vector_of(expected_values_));
}

FoundRange RobotBlocks::range_of(const VectorXd& any, const VectorXd& of_expected_size) const {
    const auto at = [&](double p) { return quantile(any, p, QuantileRule::Linear); };
    FoundRange range{at(0.5), at(0.05), at(0.95), at(assurance_)};
    if (quantity_ == ErrorQuantity::Rms) {
        const VectorXd& these = expected_ > 0 ? of_expected_size : any;
        range.expected = std::sqrt(these.squaredNorm() / static_cast<double>(these.size()));
    }
    return range;
}

double RobotBlocks::uncertainty(double FoundRange::*number) const {
    if (ranges_.size() < 2) return unknown;
    VectorXd of_blocks(count());
    for (std::size_t b = 0; b < ranges_.size(); ++b) {
        of_blocks[static_cast<Index>(b)] = ranges_[b].*number;
    }
    if (!of_blocks.allFinite()) return unknown;
    const auto blocks = static_cast<double>(of_blocks.size());
    const double square = (of_blocks.array() - of_blocks.mean()).square().sum();
    return std::sqrt(square / (blocks - 1) / blocks);
}

double RobotBlocks::doubt() const {
    double largest = 0;
    for (const auto number :
         {&FoundRange::expected, &FoundRange::lower, &FoundRange::upper, &FoundRange::assured}) {
        largest = std::max(largest, 2 * uncertainty(number));
    }
    return largest;
}

double RobotBlocks::deviation() const {
    VectorXd calibrated = vector_of(any_values_);
    const auto end = std::remove(calibrated.begin(), calibrated.end(), unknown);
    calibrated.conservativeResize(end - calibrated.begin());
    if (calibrated.size() < 2) return 0;
    const double square = (calibrated.array() - calibrated.mean()).square().sum();
    return std::sqrt(square / static_cast<double>(calibrated.size() - 1));
}

Index RobotBlocks::uncalibrated_count() const {
    return static_cast<Index>(
        std::count(any_values_.begin(), any_values_.end(), unknown) +
        std::count(expected_values_.begin(), expected_values_.end(), unknown));
}

Index RobotBlocks::needed(double tolerance) const {
    const double factor = doubt() / tolerance;
    const double blocks = static_cast<double>(count()) * factor * factor;
    return blocks < static_cast<double>(most_) ? static_cast<Index>(std::ceil(blocks)) : most_;
}

}  // namespace posewise::detail
