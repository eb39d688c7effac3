#include "fuzzed_file.hpp"
#include "posewise/io/result_files.hpp"

using namespace posewise;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return testing::read_or_refuse(data, size, "trials.sqlite", [](const std::string& path) {
        const TrialStore store = io::read_trial_store(path);
        for (const TrialSeries& series : io::series_in_store(path))
            store.finished(series, [](const Trial&) {});
    });
}
