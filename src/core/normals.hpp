#pragma once

#include "posewise/core/random.hpp"

namespace posewise::detail {

/// As many numbers as RandomStream::normal() would draw, the same ones but more quickly.
void fill_normals(RandomStream& stream, Eigen::Ref<VectorXd> numbers);

}  // namespace posewise::detail
