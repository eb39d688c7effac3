// What reaches a robot by way of an estimate: whatever happens to the file on the way.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/doubts.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using Json = nlohmann::json;

const std::string design = POSEWISE_SOURCE_DIR "/designs/fanuc_r2000ic_165f/campaign.yaml";
const std::string measured =
    POSEWISE_SOURCE_DIR "/data/fanuc_r2000ic_165f_simulated/measurements.csv";

/// A place in the file: of the whole tree, or of what says what the estimate is worth.
Json& draw_leaf(Json& root, RandomStream& random) {
    Json* at = &root;
    while (at->is_structured() && !at->empty()) {
        at = &*std::next(at->begin(), random.index(static_cast<Index>(at->size())));
    }
    return *at;
}

/// Another number, of those that go wrong: sign, units, nothing, far too large.
double other_number(double number, RandomStream& random) {
    constexpr std::array<double, 8> factors{-1, 1e3, 1e-3, 57.29577951308232, 1e9, 0, 2, 1e-9};
    const auto k = random.index(static_cast<Index>(factors.size()) + 2);
    if (k == 0) return number + 1;
    if (k == 1) return 1e3 * random.normal();
    return factors[static_cast<std::size_t>(k - 2)] * number;
}

void mutate(Json& leaf, RandomStream& random) {
    if (random.index(20) == 0) {
        leaf = nullptr;
    } else if (leaf.is_number_integer()) {
        leaf = random.index(1000) - 100;
    } else if (leaf.is_number()) {
        leaf = other_number(leaf.get<double>(), random);
    } else if (leaf.is_string()) {
        const std::array<std::string, 5> words{"", "iteration limit", "stalled", "q1",
                                               leaf.get<std::string>() + "x"};
        leaf = words[static_cast<std::size_t>(random.index(5))];
    } else if (leaf.is_boolean()) {
        leaf = !leaf.get<bool>();
    }
}

/// Why it must not reach a robot, by the file alone; empty: it may.
std::string why_refused(const Json& file, const Json& original) {
    if (file["chain"] != original["chain"]) return "another chain";
    if (file["readings"] != original["readings"]) return "another sensor";
    if (file["ending"] != "converged") return "not converged";
    constexpr double times = 100;
    for (const auto& [name, entry] : original["robot"].items()) {
        const bool turns = entry.contains("value_rad");
        const Json& value = file["robot"][name][turns ? "value_rad" : "value_m"];
        const double expected = entry[turns ? "expected_rad" : "expected_m"].get<double>();
        if (!value.is_number()) return name + " has no value";
        if (std::abs(value.get<double>()) > times * expected) return name + " is absurd";
    }
    if (!(file["variance_factor"].is_number() &&
          file["variance_factor"].get<double>() <= 300.0 * 300)) {
        return "residuals";
    }
    return "";
}

/// Whether `export` and `correct` would take it without --force.
bool is_taken(const std::string& path, const Campaign& campaign) {
    try {
        return find_faults(campaign, io::read_estimate(path, campaign)).empty();
    } catch (const InputError&) {
        return false;
    }
}

TEST(MutatedEstimates, ReachNoRobotIfNotConvergedOrOfAnotherChainOrAbsurd) {
    const testing::TemporaryFolder folder;
    const io::CampaignFile campaign = io::read_campaign(design);
    const Measurements measurements = io::read_measurements(measured, campaign);
    CalibrationOptions options;
    options.folds = 0;
    const std::string path = folder.path("estimate.json");
    io::write_estimate(path, calibrate(campaign, measurements, options), {measured});
    ASSERT_TRUE(is_taken(path, campaign));
    const Json original = Json::parse(std::ifstream(path));

    const char* const asked = std::getenv("POSEWISE_MUTANTS");  // more, once
    const int count = asked != nullptr ? std::atoi(asked) : 600;
    RandomStream random(1);
    int taken = 0, must_not = 0;
    for (int k = 0; k < count; ++k) {
        Json file = original;
        // Most of a file is its covariance.
        constexpr std::array<const char*, 4> parts{"robot", "chain", "ending", "variance_factor"};
        const auto part = static_cast<std::size_t>(random.index(6));
        mutate(draw_leaf(part < parts.size() ? file[parts[part]] : file, random), random);
        folder.write("estimate.json", file.dump());
        const std::string why = why_refused(file, original);
        const bool is_accepted = is_taken(path, campaign);
        EXPECT_FALSE(is_accepted && !why.empty()) << why << "; mutant " << k;
        taken += is_accepted ? 1 : 0;
        must_not += why.empty() ? 0 : 1;
    }
    EXPECT_GT(must_not, count / 4);
    EXPECT_GT(taken, count / 10);  // many changes do no harm
}

}  // namespace
}  // namespace posewise
