#pragma once

#include <string>
#include <vector>

#include "posewise/core/blocks.hpp"

/// Plain blocks in files, anybody's Jacobians: CSV, blanks (numpy.savetxt()), MATLAB, .npy, .npz.
namespace posewise::io {

/// What a file of blocks holds. Every block has as many rows.
struct BlocksFile {
    Blocks blocks;
    Index rows_per_block = 0;
    std::vector<std::string> names{};   ///< parameter names; empty: the file has none
    std::vector<std::string> doubts{};  ///< why the rows may not be meant so, a sentence each
};

/// Reads blocks of equal height. `rows_per_block` may be 0 if the file holds three dimensions
/// (candidates x rows x parameters). `variable`: of a .mat or .npz file; empty: the first. Throws
/// InputError if that contradicts the file or is missing, if it does not divide the number of rows,
/// and as make_equal_blocks() does.
BlocksFile read_blocks(const std::string& path, Index rows_per_block = 0,
                       const std::string& variable = "");

/// Writes blocks of equal height: .npy, .npz (variable `blocks`) in three dimensions, else CSV,
/// with these names of the parameters, if any, as header. Throws InputError if the heights differ
/// or the file cannot be written.
void write_blocks(const std::string& path, const Blocks& blocks,
                  const std::vector<std::string>& names = {});

/// Indices of candidates from 0 to `candidate_count` - 1, in any shape of matrix, in the order of
/// the file; or the ids of a plan of plain blocks (.json). Throws InputError for others.
std::vector<Index> read_subset(const std::string& path, Index candidate_count);

}  // namespace posewise::io
