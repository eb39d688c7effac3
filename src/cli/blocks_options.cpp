#include "blocks_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common.hpp"
#include "core/text.hpp"
#include "options.hpp"

namespace posewise::cli {
namespace {

bool has_variables(const std::string& path) {
    return path.ends_with(".mat") || path.ends_with(".MAT") || path.ends_with(".npz");
}

/// Whether the file may say itself how many rows a candidate has.
bool may_be_stacked(const std::string& path) {
    return path.ends_with(".npy") || path.ends_with(".npz");
}

}  // namespace

CLI::Option* add_blocks_option(CLI::App& group, std::string& blocks) {
    return group
        .add_option("--blocks", blocks,
                    "Plain blocks, no robot: CSV, blanks (numpy.savetxt), .npy, .npz, MATLAB .mat")
        ->check(file_name());
}

void add_blocks_layout(CLI::App& command, PlanSources& sources) {
    command
        .add_option(
            "--rows", sources.rows_per_block,
            "With --blocks: rows of one candidate (default: of an array candidates x rows x "
            "parameters its own)")
        ->check(whole_number(1, 1000000));
    command.add_option("--variable", sources.variable,
                       "With --blocks: variable of the .mat or .npz file (default: the first)");
}

void check_blocks_usage(const std::string& blocks, const PlanSources& sources) {
    if (blocks.empty() && sources.rows_per_block > 0) {
        throw CLI::ValidationError("--rows", "goes with --blocks only");
    }
    if (!blocks.empty() && sources.rows_per_block == 0 && !may_be_stacked(blocks)) {
        throw CLI::ValidationError("--rows", "is required with --blocks");
    }
    if (!sources.variable.empty() && !has_variables(blocks)) {
        throw CLI::ValidationError("--variable", "goes with --blocks and a .mat or .npz file only");
    }
}

void check_only(const CLI::App& command, const std::vector<std::string>& used,
                const std::string& rule) {
    for (const CLI::Option* option : command.get_options()) {
        const std::string name = option->get_name();
        if (option->count() == 0 || std::ranges::find(used, name) != used.end()) continue;
        throw CLI::ValidationError(name, rule);
    }
}

io::BlocksFile read_blocks(const std::string& path, const PlanSources& sources) {
    io::BlocksFile file = io::read_blocks(path, sources.rows_per_block, sources.variable);
    for (const std::string& doubt : file.doubts) {
        print_warning(detail::escape_controls(path) + ": " + doubt);
    }
    return file;
}

void print_size(const Blocks& blocks, const CommonOptions& common) {
    if (common.json) return;
    print(fmt::format("{}, {}, {}\n", detail::count_of(blocks.count(), "candidate"),
                      detail::count_of(blocks[0].rows(), "row"),
                      detail::count_of(blocks.parameter_count(), "parameter")));
}

}  // namespace posewise::cli
