#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"

/// What commands check about their files.
namespace posewise::cli {

/// Once the campaigns are read, before anything is computed: throws InputError if an output is an
/// input (also a URDF that a campaign names) or another output (by whatever path or link), if no
/// file can be written there, or if it is standard output, which with --json holds one document and
/// nothing else. Empty paths and missing campaigns do not count.
void check_outputs(const std::vector<const io::CampaignFile*>& campaigns,
                   std::vector<std::string> inputs, const std::vector<std::string>& outputs,
                   const CommonOptions& common);

/// What `compute` returns; its InputErrors, which are about the content of the file, name it,
/// unless they name a file already.
template <class Compute>
auto compute_from(const std::string& path, Compute&& compute) {
    try {
        return std::forward<Compute>(compute)();
    } catch (const InputError& error) {
        if (std::string_view(error.what()).starts_with(path + ": ")) throw;
        throw input_error_at({path}, error.what());
    }
}

}  // namespace posewise::cli
