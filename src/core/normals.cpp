#include "normals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "elementary_vectors.hpp"

namespace posewise::detail {
namespace {

constexpr std::size_t most_at_once = 64;
using Numbers = std::array<double, most_at_once>;

template <typename V>
POSEWISE_INLINE void load(const Numbers& from, std::size_t first, V& v) {
    for (std::size_t k = 0; k < sizeof(V) / sizeof(double); ++k) v[k] = from[first + k];
}

/// Box-Muller of so many pairs, as RandomStream::normal() has it.
struct BoxMuller {
    const Numbers& u;
    const Numbers& v;
    std::size_t count;
    Numbers& result;

    template <typename V>
    POSEWISE_INLINE void run() const {
        constexpr std::size_t lanes = sizeof(V) / sizeof(double);
        for (std::size_t first = 0; first < count; first += lanes) {
            V radius{}, angle{}, sine, cosine;
            load(u, first, radius);
            load(v, first, angle);
            logarithms(V(radius), radius);
            radius *= -2.0;
            angle *= 2.0 * std::numbers::pi;
            sines_and_cosines(angle, sine, cosine);
            for (std::size_t k = 0; k < lanes; ++k) {
                result[first + k] = std::sqrt(radius[k]) * cosine[k];
            }
        }
    }
};

}  // namespace

void fill_normals(RandomStream& stream, Eigen::Ref<VectorXd> numbers) {
    std::array<double, 2 * most_at_once> drawn;
    Numbers u, v, normals;
    for (Index first = 0; first < numbers.size(); first += Index{most_at_once}) {
        const auto count =
            static_cast<std::size_t>(std::min(Index{most_at_once}, numbers.size() - first));
        stream.fill_uniform(std::span(drawn).first(2 * count));
        for (std::size_t k = 0; k < count; ++k) {
            u[k] = 1.0 - drawn[2 * k];  // above 0
            v[k] = drawn[2 * k + 1];
        }
        for (std::size_t k = count; k < std::min(count + simd::most_lanes, most_at_once); ++k) {
            u[k] = 1;  // where a vector is not full
            v[k] = 0;
        }
        simd::run(BoxMuller{u, v, count, normals});
        for (std::size_t k = 0; k < count; ++k) numbers[first + static_cast<Index>(k)] = normals[k];
    }
}

}  // namespace posewise::detail
