#include "halton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {
namespace {

/// The radical inverse in one base: the digits of an index, mirrored at the point.
class RadicalInverse {
  public:
    explicit RadicalInverse(Index base) : base_(base) {}

    /// Permutes every digit that a double can hold, each position by its own permutation.
    void scramble(RandomStream stream) {
        for (double weight = 1; weight > 0x1.0p-53; weight /= static_cast<double>(base_)) {
            auto& digits = permutations_.emplace_back(static_cast<std::size_t>(base_));
            std::iota(digits.begin(), digits.end(), Index{0});
            for (std::size_t k = digits.size() - 1; k > 0; --k) {
                const Index other = stream.index(static_cast<Index>(k + 1));
                std::swap(digits[k], digits[static_cast<std::size_t>(other)]);
            }
        }
    }

    /// In [0, 1).
    double operator()(Index index) const {
        double value = 0;
        double weight = 1;
        for (std::size_t position = 0; index > 0 || position < permutations_.size(); ++position) {
            Index digit = index % base_;
            if (position < permutations_.size()) {
                digit = permutations_[position][static_cast<std::size_t>(digit)];
            }
            weight /= static_cast<double>(base_);
            value += weight * static_cast<double>(digit);
            index /= base_;
        }
        return std::min(value, 1 - 0x1.0p-53);
    }

  private:
    Index base_;
    std::vector<std::vector<Index>> permutations_;  // one a digit; empty: plain
};

std::vector<Index> first_primes(std::size_t count) {
    std::vector<Index> primes;
    for (Index n = 2; primes.size() < count; ++n) {
        const bool is_prime =
            std::none_of(primes.begin(), primes.end(), [n](Index prime) { return n % prime == 0; });
        if (is_prime) primes.push_back(n);
    }
    return primes;
}

void check_bases(const std::vector<Index>& bases, Index joint_count) {
    if (static_cast<Index>(bases.size()) != joint_count) {
        throw InputError("there are " + std::to_string(bases.size()) + " Halton bases for " +
                         std::to_string(joint_count) + " joints, must be one a joint");
    }
    for (std::size_t j = 0; j < bases.size(); ++j) {
        if (bases[j] < 2 || bases[j] > 100000) {
            throw InputError("Halton base " + std::to_string(bases[j]) +
                             " must be from 2 to 100000");
        }
        for (std::size_t i = 0; i < j; ++i) {
            if (std::gcd(bases[i], bases[j]) != 1) {
                throw InputError("Halton bases " + std::to_string(bases[i]) + " and " +
                                 std::to_string(bases[j]) +
                                 " have a common factor, must have none: their joints would move "
                                 "together");
            }
        }
    }
}

}  // namespace

RowMatrixXd halton_configurations(const Chain& chain, Index count, const HaltonOptions& options) {
    if (count < 0 || options.first_index < 0) {
        throw InputError("count and first index of a Halton sequence must not be negative, are " +
                         std::to_string(count) + " and " + std::to_string(options.first_index));
    }
    if (!chain.torques().empty()) {
        throw InputError(
            "the robot's torques are measured with each configuration, and of one that is drawn "
            "they are not known; state the weights of links and payload instead (compliance)");
    }
    const std::vector<Index> bases =
        options.bases.empty() ? first_primes(chain.joints().size()) : options.bases;
    check_bases(bases, chain.joint_count());
    RowMatrixXd configurations(count, chain.joint_count());
    for (Index j = 0; j < chain.joint_count(); ++j) {
        RadicalInverse inverse(bases[static_cast<std::size_t>(j)]);
        if (options.scramble_seed) {
            inverse.scramble(RandomStream(*options.scramble_seed, static_cast<std::uint64_t>(j)));
        }
        const Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
        for (Index i = 0; i < count; ++i) {
            const double share = inverse(options.first_index + i);
            configurations(i, j) = joint.lower + (joint.upper - joint.lower) * share;
        }
    }
    return configurations;
}

Chain with_margin(const Chain& chain, const JointMargin& margin) {
    std::vector<Joint> joints = chain.joints();
    for (Joint& joint : joints) {
        const double inset = joint.motion == Motion::Rotation ? margin.angle : margin.length;
        if (!(inset >= 0) || !(joint.lower + inset < joint.upper - inset)) {
            throw InputError(
                fmt::format("margin {:g} of joint '{}' must not be negative and must leave "
                            "something of its range {:g} to {:g} (rad or m)",
                            inset, joint.name, joint.lower, joint.upper));
        }
        joint.lower += inset;
        joint.upper -= inset;
    }
    return Chain(std::move(joints), chain.elements(), chain.torques());
}

}  // namespace posewise::detail
