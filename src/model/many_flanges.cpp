#include <algorithm>
#include <array>
#include <cmath>

#include "core/elementary_vectors.hpp"
#include "element_amount.hpp"

namespace posewise {
namespace {

/// An element as all configurations are taken through it.
struct Step {
    Motion motion;
    Index axis;
    bool is_constant;
    double amount = 0;              ///< if it is constant
    detail::SineCosine turn{};      ///< of that
    std::vector<double> amounts{};  ///< else, of each configuration and some zeros
};

/// The running product of as many configurations side by side as a vector has numbers.
struct ManyFlanges {
    const std::vector<Step>& steps;
    std::vector<Isometry3d>& flanges;

    template <typename V>
    POSEWISE_INLINE void run() const {
        constexpr Index lanes = detail::simd::width<V>;
        const Index count = std::ssize(flanges);
        for (Index first = 0; first < count; first += lanes) {
            std::array<V, 9> R{};  // column by column
            std::array<V, 3> p{};
            R[0] += 1.0;
            R[4] += 1.0;
            R[8] += 1.0;
            for (const Step& step : steps) advance(step, first, R, p);
            for (Index lane = 0; lane < std::min(lanes, count - first); ++lane) {
                Isometry3d& flange = flanges[static_cast<std::size_t>(first + lane)];
                for (Index k = 0; k < 9; ++k) {
                    flange.linear()(k % 3, k / 3) = R[static_cast<std::size_t>(k)][lane];
                }
                for (Index k = 0; k < 3; ++k) {
                    flange.translation()[k] = p[static_cast<std::size_t>(k)][lane];
                }
                flange.makeAffine();
            }
        }
    }

  private:
    template <typename V>
    POSEWISE_INLINE static void advance(const Step& step, Index first, std::array<V, 9>& R,
                                        std::array<V, 3>& p) {
        V amount = V{} + step.amount;
        if (!step.is_constant) {
            for (Index lane = 0; lane < detail::simd::width<V>; ++lane) {
                amount[lane] = step.amounts[static_cast<std::size_t>(first + lane)];
            }
        }
        const auto a = static_cast<std::size_t>(step.axis);
        if (step.motion == Motion::Translation) {
            for (std::size_t row = 0; row < 3; ++row) p[row] += amount * R[3 * a + row];
            return;
        }
        V s = V{} + step.turn.sine;
        V c = V{} + step.turn.cosine;
        if (!step.is_constant) detail::sines_and_cosines(amount, s, c);
        const std::size_t i = (a + 1) % 3;
        const std::size_t j = (a + 2) % 3;
        for (std::size_t row = 0; row < 3; ++row) {
            const V column = R[3 * i + row];
            R[3 * i + row] = c * column + s * R[3 * j + row];
            R[3 * j + row] = c * R[3 * j + row] - s * column;
        }
    }
};

/// The element's amounts at all configurations; `next` as for amount_of().
void fill_amounts(const Element& element, const RowMatrixXd& configurations,
                  const VectorXd& parameters, Index& next, std::vector<double>& amounts) {
    const Index count = configurations.rows();
    if (element.has_functions()) {
        const Index first = next;
        VectorXd q;
        for (Index i = 0; i < count; ++i) {
            next = first;
            q = configurations.row(i).transpose();
            amounts[static_cast<std::size_t>(i)] = detail::amount_of(element, q, parameters, next);
        }
        return;
    }
    // The same sum for all of them at once.
    Eigen::Map<VectorXd> sum(amounts.data(), count);
    sum.setConstant(element.value);
    for (const JointTerm& term : element.joints) {
        sum += term.coefficient * configurations.col(term.joint);
    }
    if (!element.parameter.empty()) sum.array() += parameters[next++];
}

bool is_in_reach(const Step& step) {
    return std::all_of(step.amounts.begin(), step.amounts.end(),
                       [](double x) { return std::abs(x) < detail::most_turned; });
}

}  // namespace

std::vector<Isometry3d> Chain::base_from_flanges(const RowMatrixXd& configurations,
                                                 const VectorXd& parameters) const {
    const Index count = configurations.rows();
    std::vector<Step> steps;
    Index next = 0;
    for (const Element& element : elements()) {
        Step step{element.motion, static_cast<Index>(element.axis),
                  element.joints.empty() && !element.has_functions()};
        if (step.is_constant) {
            step.amount = detail::amount_of(element, {}, parameters, next);
            step.turn = detail::sine_and_cosine(step.amount);
        } else {
            step.amounts.resize(static_cast<std::size_t>(count + detail::simd::most_lanes));
            fill_amounts(element, configurations, parameters, next, step.amounts);
        }
        steps.push_back(std::move(step));
    }
    std::vector<Isometry3d> flanges(static_cast<std::size_t>(count));
    if (std::all_of(steps.begin(), steps.end(), is_in_reach)) {
        // Turns by 0 are left out, as they are of one flange.
        std::erase_if(steps, [](const Step& step) {
            return step.is_constant && step.motion == Motion::Rotation && step.amount == 0;
        });
        detail::simd::run(ManyFlanges{steps, flanges});
        return flanges;
    }
    for (Index i = 0; i < count; ++i) {
        flanges[static_cast<std::size_t>(i)] =
            base_from_flange(configurations.row(i).transpose(), parameters);
    }
    return flanges;
}

}  // namespace posewise
