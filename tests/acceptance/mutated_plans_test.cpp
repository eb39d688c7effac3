// What is done by a plan: whatever happens to the file on the way.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "../../src/model/joint_limits.hpp"
#include "../../src/task/plan/planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/planning.hpp"
#include "support/json_mutants.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;
using Json = nlohmann::ordered_json;

const std::string cell_design = source_folder() + "/tests/fuzz/corpus/campaign/points.yaml";
const std::vector<std::string> words{"optimal", "converged", "time limit",     "d",     "robot",
                                     "1",       "random",    "configurations", "crane", "1/"};

/// Something left out, or twice.
void restructure(Json& root, RandomStream& random) {
    Json* at = &root;
    while (at->is_structured() && !at->empty()) {
        const auto child = std::next(at->begin(), random.index(std::ssize(*at)));
        const bool is_here = random.index(3) == 0 || !child->is_structured();
        if (is_here && at->is_array() && random.index(2) == 0) return at->push_back(Json(*child));
        if (is_here) {
            at->erase(child);
            return;
        }
        at = &*child;
    }
}

/// Any one change, of the whole file or of what matters: most of a file is its certificate.
void change(Json& file, RandomStream& random) {
    constexpr std::array<const char*, 6> parts{"candidates", "problem",   "poses",
                                               "search",     "predicted", "assumes"};
    const auto part = static_cast<std::size_t>(random.index(9));
    const bool is_part = part < parts.size() && file.contains(parts[part]);
    Json& root = is_part ? file[parts[part]] : file;
    if (random.index(10) == 0) return restructure(root, random);
    mutate(draw_leaf(root, random), words, random);
}

/// The places where two files differ, numbers by more than rounding; indices of lists as "#".
std::set<std::string> find_changes(const Json& before, const Json& now) {
    std::set<std::string> places;
    for (const Json& step : Json::diff(before, now)) {
        const Json::json_pointer place(step["path"].get<std::string>());
        const bool is_number = before.contains(place) && before[place].is_number() &&
                               now.contains(place) && now[place].is_number();
        if (is_number) {
            // Of a matrix what counts beside its diagonal.
            const bool is_certificate = step["path"].get<std::string>().starts_with("/certificate");
            const double least =
                is_certificate ? 1e-6 * before["certificate"]["M_lower"].back().back().get<double>()
                               : 1e-9;
            const double a = before[place].get<double>(), b = now[place].get<double>();
            if (std::abs(a - b) <= std::max(least, 1e-6 * std::max(std::abs(a), std::abs(b)))) {
                continue;
            }
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

/// A plan, how it is verified, and the places whose change does no harm: what is only said (of the
/// search, for people), files that are read then, and what a bound is proven without.
struct Case {
    std::string name;
    Json file;
    std::function<Verification(const Plan&)> verify;
    std::set<std::string> harmless;
};

/// Plans of each kind for a small robot, and what they were made from.
class MutatedPlans : public ::testing::Test {
  protected:
    MutatedPlans() {
        measured_ = simulate(campaign_, {.pose_count = 12}).measurements;
        cases_ = {choice(), random_choice(), poses()};
        for (Case& one : cases_) {
            for (const char* const said :
                 {"/posewise_version", "/format", "/candidates/campaign_file", "/candidates/source",
                  "/search/starts", "/search/starts_at_best", "/search/tried",
                  "/search/stop_reason", "/search/proof_s", "/warnings",
                  "/problem/verification_count"}) {
                one.harmless.insert(said);
            }
        }
    }

    Json write(const Plan& plan) const {
        io::write_plan(path_, plan);
        return Json::parse(std::ifstream(path_));
    }

    Plan read(const Json& file) const {
        folder_.write("plan.json", file.dump());
        return io::read_plan(path_);
    }

    /// As the program: with the prior that the plan says.
    io::CampaignFile campaign_of(const Plan& plan) const {
        io::CampaignFile campaign = campaign_;
        io::set_prior(campaign, plan.request.has_prior);
        return campaign;
    }

    /// Six of those measured, optimal, which is proven without the certificate, too.
    Case choice() const {
        ChoiceOptions asked;
        asked.pose_count = 6;
        asked.criterion = Criterion::O3;
        asked.sources.campaign = cell_design;
        asked.sources.candidates = "measured.csv";
        const Candidates candidates = measured_candidates(measured_);
        return {"choice",
                write(choose(campaign_, candidates, asked)),
                [this, candidates](const Plan& plan) {
                    ChoiceOptions options;
                    static_cast<PlanRequest&>(options) = plan.request;
                    return verify(plan, campaign_of(plan), candidates, options);
                },
                {"/candidates/kind", "/problem/group_limit", "/poses/#/visible_targets",
                 "/search/seed", "/certificate/sharpness", "/certificate/M_lower/#/#"}};
    }

    /// Eight random configurations of 40, the bound by the certificate alone.
    Case random_choice() const {
        ChoiceOptions asked;
        asked.pose_count = 8;
        asked.criterion = Criterion::D;
        asked.proof = 0;
        asked.sources.campaign = cell_design;
        const Plan made =
            choose(campaign_, random_candidates(campaign_, 40, campaign_.seed), asked);
        EXPECT_EQ(made.ending, Ending::Converged);
        return {"random choice",
                write(made),
                [this](const Plan& plan) {
                    const io::CampaignFile campaign = campaign_of(plan);
                    ChoiceOptions options;
                    static_cast<PlanRequest&>(options) = plan.request;
                    const Index count = std::min<Index>(plan.candidate_count, 1000);
                    return verify(plan, campaign,
                                  random_candidates(campaign, count, plan.request.seed.value()),
                                  options);
                },
                {"/candidates/kind", "/problem/group_limit", "/poses/#/visible_targets"}};
    }

    /// Five continuous poses, one with a configuration on the way to it.
    Case poses() const {
        PlanningOptions asked(5);
        asked.pool_count = 200;
        asked.workspace_count = 10;
        asked.starts = 1;
        asked.sources.campaign = cell_design;
        Json file = write(make_plan(campaign_, asked).plan);
        file["poses"][2]["via"] = file["poses"][1]["joints"];
        return {"poses",
                file,
                [this](const Plan& plan) {
                    PlanningOptions options;
                    static_cast<PlanRequest&>(options) = plan.request;
                    return verify(plan, campaign_of(plan), options);
                },
                {
                    "/candidates/drawn",
                    "/candidates/count",
                    "/poses/#/id",
                    "/poses/#/kept",
                    "/poses/#/clearance_m",  // older files have none
                    "/poses/#/nearest",
                    "/poses/#/readable",  // may be left out; beside joints it must agree
                    "/poses/#/way_is_blocked",
                    "/poses/#/via/q1_rad",
                    "/poses/#/via/q2_rad",
                    "/poses/#/via/lift_m",
                    "/search/seed",
                    "/problem/time_limit_s",
                    "/visiting_time_s",
                    "/duration_s",  // a statement about the cell's times, as that is
                    "/bounds/pool/is_proven",
                    "/bounds/continuous/is_proven",
                }};
    }

    const TemporaryFolder folder_;
    const std::string path_ = folder_.path("plan.json");
    const io::CampaignFile campaign_ = io::read_campaign(cell_design);
    Measurements measured_;
    std::vector<Case> cases_;
};

TEST_F(MutatedPlans, AreNotVerified) {
    const auto is_taken = [&](const Case& one, const Json& file) {
        try {
            return one.verify(read(file)).is_right();
        } catch (const InputError&) {
            return false;
        }
    };
    for (const Case& one : cases_) ASSERT_TRUE(is_taken(one, one.file)) << one.name;
    RandomStream random(1);
    int taken = 0;
    for (int k = 0; k < mutant_count(); ++k) {
        const Case& one = cases_[static_cast<std::size_t>(k % 3)];
        Json file = one.file;
        change(file, random);
        if (!is_taken(one, file)) continue;
        ++taken;
        for (const std::string& place : find_changes(one.file, file)) {
            EXPECT_TRUE(one.harmless.contains(place)) << one.name << place << "; mutant " << k;
        }
    }
    EXPECT_GT(taken, mutant_count() / 20);
}

/// Gives mutants of a plan to `take`, which checks what it makes of them or refuses them by an
/// InputError. Some do no harm.
template <class Take>
void take_mutants(const Json& plan, std::uint64_t seed, const Take& take) {
    RandomStream random(seed);
    int taken = 0;
    for (int k = 0; k < mutant_count(); ++k) {
        SCOPED_TRACE("mutant " + std::to_string(k));
        Json file = plan;
        change(file, random);
        try {
            take(file);
            ++taken;
        } catch (const InputError&) {
        }
    }
    EXPECT_GT(taken, mutant_count() / 20);
}

/// `calibrate --plan`, `indices --plan`.
TEST_F(MutatedPlans, AreNotCalibratedWith) {
    const Case& one = cases_.front();
    const auto planned = find_planned(read(one.file), campaign_, measured_);
    ASSERT_EQ(planned.size(), 6U);
    take_mutants(one.file, 2, [&](const Json& file) {
        EXPECT_EQ(find_planned(read(file), campaign_, measured_), planned);
    });
}

/// `plan --plan`: what is kept can be measured.
TEST_F(MutatedPlans, AreNotRepairedBeyondTheLimits) {
    PlanningOptions asked(5);
    take_mutants(cases_.back().file, 3, [&](const Json& file) {
        asked.repaired = read(file);
        const auto kept = detail::state_planning(campaign_, asked).kept;
        EXPECT_EQ(kept.size(), 5U);
        for (const PlannedPose& pose : kept) {
            EXPECT_EQ(detail::describe_limit_violation(campaign_.robot, pose.configuration), "");
        }
    });
}

}  // namespace
}  // namespace posewise
