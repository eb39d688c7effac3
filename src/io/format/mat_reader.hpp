#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"

struct _mat_t;

namespace posewise::detail {

/// Real matrices of a MATLAB file of version 5 to 7.3. Whatever is wrong with the file or a
/// variable throws InputError.
class MatReader {
  public:
    explicit MatReader(const std::string& path);

    /// A variable of `columns` columns (nothing: any number) and at least one row, all finite.
    MatrixXd read(const std::string& name, std::optional<Index> columns = std::nullopt) const;

    /// The same, where rows may be missing: all of NaN.
    MatrixXd read_with_gaps(const std::string& name, Index columns) const;

    /// The first variable of the file.
    MatrixXd read_first() const;

  private:
    MatrixXd read_unchecked(const std::string& name, std::optional<Index> columns) const;

    std::string path_;
    std::size_t byte_count_ = 0;
    std::unique_ptr<_mat_t, int (*)(_mat_t*)> file_;
};

}  // namespace posewise::detail
