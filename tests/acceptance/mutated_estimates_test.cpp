// What reaches a robot by way of an estimate: whatever happens to the file on the way.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/task/doubts.hpp"
#include "support/json_mutants.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;
using Json = nlohmann::ordered_json;

const std::string design = source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml";
const std::string measured =
    source_folder() + "/data/fanuc_r2000ic_165f_simulated/measurements.csv";

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
    const TemporaryFolder folder;
    const io::CampaignFile campaign = io::read_campaign(design);
    const Measurements measurements = io::read_measurements(measured, campaign);
    CalibrationOptions options;
    options.folds = 0;
    const std::string path = folder.path("estimate.json");
    io::write_estimate(path, calibrate(campaign, measurements, options), {measured});
    ASSERT_TRUE(is_taken(path, campaign));
    const Json original = Json::parse(std::ifstream(path));

    const int count = mutant_count();
    const std::vector<std::string> words{"iteration limit", "stalled", "q1"};
    RandomStream random(1);
    int taken = 0, must_not = 0;
    for (int k = 0; k < count; ++k) {
        Json file = original;
        // Most of a file is its covariance.
        constexpr std::array<const char*, 4> parts{"robot", "chain", "ending", "variance_factor"};
        const auto part = static_cast<std::size_t>(random.index(6));
        mutate(draw_leaf(part < parts.size() ? file[parts[part]] : file, random), words, random);
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
