#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

/// What a fuzzer calls with each input; 0: go on.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace posewise::testing {

/// One of the small campaigns in corpus/campaign.
inline io::CampaignFile corpus_campaign(const std::string& name) {
    return io::read_campaign(source_folder() + "/tests/fuzz/corpus/campaign/" + name + ".yaml");
}

/// Lets `read` have an input as a file of this name. It must take it or throw an InputError of one
/// line that begins with the file's path; anything else ends the program, and leaves the file.
template <class Read>
int read_or_refuse(const std::uint8_t* data, std::size_t size, const std::string& name,
                   const Read& read) {
    static const TemporaryFolder folder;
    const std::string path =
        folder.write(name, std::string(reinterpret_cast<const char*>(data), size));
    try {
        read(path);
    } catch (const InputError& error) {
        const std::string_view message = error.what();
        if (!message.starts_with(path) || message.find('\n') != message.npos) {
            std::fprintf(stderr, "%s\n", error.what());
            std::abort();
        }
    }
    return 0;
}

}  // namespace posewise::testing
