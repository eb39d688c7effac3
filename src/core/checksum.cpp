#include "checksum.hpp"

#include <fmt/format.h>

#include <bit>

namespace posewise::detail {

void Checksum::add(std::uint64_t word) {
    for (int byte = 0; byte < 8; ++byte) {
        state_ = (state_ ^ ((word >> (8 * byte)) & 0xffU)) * 0x100000001b3U;
    }
}

void Checksum::add(const RowMatrixXd& matrix) {
    add(static_cast<std::uint64_t>(matrix.rows()));
    add(static_cast<std::uint64_t>(matrix.cols()));
    for (Index k = 0; k < matrix.size(); ++k) add(std::bit_cast<std::uint64_t>(matrix.data()[k]));
}

void Checksum::add(const std::string& text) {
    add(static_cast<std::uint64_t>(text.size()));
    for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
}

std::string Checksum::text() const { return fmt::format("fnv1a64:{:016x}", state_); }

}  // namespace posewise::detail
