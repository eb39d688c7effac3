#include "normals.hpp"

#include <array>
#include <cmath>
#include <numbers>

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
            V radius, angle, sine, cosine;
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
    Numbers u, v, normals;
    u.fill(1);  // beyond those drawn, where a vector is not full
    v.fill(0);
    for (Index first = 0; first < numbers.size(); first += Index{most_at_once}) {
        const Index count = std::min(Index{most_at_once}, numbers.size() - first);
        for (Index k = 0; k < count; ++k) {
            u[static_cast<std::size_t>(k)] = 1.0 - stream.uniform();  // above 0
            v[static_cast<std::size_t>(k)] = stream.uniform();
        }
        simd::run(BoxMuller{u, v, static_cast<std::size_t>(count), normals});
        for (Index k = 0; k < count; ++k) numbers[first + k] = normals[static_cast<std::size_t>(k)];
    }
}

}  // namespace posewise::detail
