// What is done by a plan: whatever happens to the file on the way.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "../../src/task/planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/measurement/simulation.hpp"
#include "posewise/task/verification.hpp"
#include "support/json_mutants.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;
using Json = nlohmann::json;

const std::string design = POSEWISE_SOURCE_DIR "/tests/fuzz/corpus/campaign/points.yaml";
const std::vector<std::string> words{"optimal", "converged", "time limit",     "d",     "robot",
                                     "1",       "random",    "configurations", "crane", "1/"};

/// Any change, of the whole file or of what matters; its place is "poses/3/joints/q1_rad".
std::string change(Json& file, RandomStream& random) {
    constexpr std::array<const char*, 6> parts{"candidates", "problem",     "poses",
                                               "search",     "certificate", "bounds"};
    const auto part = static_cast<std::size_t>(random.index(10));
    const bool is_part = part < parts.size() && file.contains(parts[part]);
    Json& root = is_part ? file[parts[part]] : file;
    mutate(draw_leaf(root, random), words, random);
    return "";
}

/// The places where two files differ, numbers by more than rounding; indices of lists as "#".
std::set<std::string> find_changes(const Json& before, const Json& now) {
    std::set<std::string> places;
    for (const Json& step : Json::diff(before, now)) {
        const Json::json_pointer place(step["path"].get<std::string>());
        const bool is_number = before.contains(place) && before[place].is_number() &&
                               now.contains(place) && now[place].is_number();
        if (is_number) {
            const double a = before[place].get<double>(), b = now[place].get<double>();
            if (std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b))) continue;
        }
        std::string name;
        for (std::string rest = place.to_string(); !rest.empty();) {
            const std::size_t end = std::min(rest.find('/', 1), rest.size());
            const std::string key = rest.substr(1, end - 1);
            const bool is_index = !key.empty() && key.find_first_not_of("0123456789") == key.npos;
            name += "/" + (is_index ? "#" : key);
            rest.erase(0, end);
        }
        places.insert(name);
    }
    return places;
}

/// Plans of each kind for a small robot, and what they were made from.
class MutatedPlans : public ::testing::Test {
  protected:
    MutatedPlans() {
        SimulateOptions simulated;
        simulated.pose_count = 12;
        measured_ = simulate(campaign_, simulated).measurements;
    }

    Json write(const Plan& plan) const {
        io::write_plan(path_, plan);
        return Json::parse(std::ifstream(path_));
    }

    const TemporaryFolder folder_;
    const std::string path_ = folder_.path("plan.json");
    const io::CampaignFile campaign_ = io::read_campaign(design);
    Measurements measured_;
};

void report(const std::map<std::string, int>& taken) {
    for (const auto& [place, count] : taken) std::printf("%6d %s\n", count, place.c_str());
}

TEST_F(MutatedPlans, AreNotVerified) {
    ChoiceOptions asked;
    asked.pose_count = 6;
    asked.criterion = Criterion::O3;
    asked.sources.campaign = design;
    asked.sources.candidates = "m.csv";
    const Json choice = write(choose(campaign_, measured_candidates(measured_), asked));
    PlanningOptions planned;
    planned.pose_count = 5;
    planned.pool_count = 200;
    planned.workspace_count = 10;
    planned.starts = 1;
    planned.criterion = Criterion::V;
    planned.sources.campaign = design;
    const Json pool = write(make_plan(campaign_, planned).plan);

    const auto is_taken = [&] {
        try {
            const Plan plan = io::read_plan(path_);
            io::CampaignFile campaign = campaign_;
            io::set_prior(campaign, plan.request.has_prior);
            if (plan.is_continuous()) {
                PlanningOptions options;
                static_cast<PlanRequest&>(options) = plan.request;
                return verify(plan, campaign, options).is_right();
            }
            ChoiceOptions options;
            static_cast<PlanRequest&>(options) = plan.request;
            return verify(plan, campaign, measured_candidates(measured_), options).is_right();
        } catch (const InputError&) {
            return false;
        }
    };
    RandomStream random(1);
    std::map<std::string, int> taken;
    for (int k = 0; k < mutant_count(); ++k) {
        const Json& original = k % 2 == 0 ? choice : pool;
        Json file = original;
        change(file, random);
        folder_.write("plan.json", file.dump());
        if (!is_taken()) continue;
        const auto places = find_changes(original, file);
        for (const std::string& place : places)
            ++taken[(k % 2 == 0 ? "choice" : "pool") + place + " " +
                    file.at(Json::json_pointer("/search")).dump()];
    }
    report(taken);
}

}  // namespace
}  // namespace posewise
