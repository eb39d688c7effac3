#pragma once

#include <cstdint>
#include <string>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Tells whether numbers and names are still those they were (FNV-1a, 64 bits); the same on every
/// machine. No protection against forgery.
class Checksum {
  public:
    void add(const RowMatrixXd& matrix);
    void add(const std::string& text);

    /// "fnv1a64:" and 16 hexadecimal digits.
    std::string text() const;

  private:
    void add(std::uint64_t word);

    std::uint64_t state_ = 0xcbf29ce484222325U;
};

/// Of a text alone.
inline std::string checksum_of(const std::string& text) {
    Checksum checksum;
    checksum.add(text);
    return checksum.text();
}

}  // namespace posewise::detail
