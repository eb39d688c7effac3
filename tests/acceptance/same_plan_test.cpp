// The same plan files whatever the vectors and caches of the CPU.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <sstream>

#include "../../src/core/simd.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"
#include "support/campaign_from.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;

/// The bytes of a plan file.
std::string written(const Plan& plan) {
    const TemporaryFolder folder;
    io::write_plan(folder.path("plan.json"), plan);
    std::ostringstream text;
    text << std::ifstream(folder.path("plan.json"), std::ios::binary).rdbuf();
    return text.str();
}

std::string chosen(Criterion criterion) {
    const auto campaign = design_campaign("fanuc_r2000ic_165f/campaign.yaml");
    ChoiceOptions options;
    options.criterion = criterion;
    options.pose_count = 8;
    options.starts = 2;
    return written(choose(campaign, random_candidates(campaign, 150, 1), options));
}

std::string planned() {
    const auto file = design_campaign("cell_demo/campaign.yaml");
    PlanningOptions options(6);
    options.criterion = Criterion::D;
    options.pool_count = 800;
    options.starts = 2;
    options.workspace_count = 20;
    return written(make_plan(file, options).plan);
}

/// Restores what the other tests run with.
struct UsualMachine {
    ~UsualMachine() {
        fix_cache_sizes();
        detail::simd::use_width(detail::simd::widest());
    }
};

void expect_the_same_everywhere(const std::function<std::string()>& make) {
    const UsualMachine usual;
    detail::simd::use_width(2);
    const std::string expected = make();
    for (const int width : {4, 8}) {
        if (width > detail::simd::widest()) continue;
        detail::simd::use_width(width);
        EXPECT_EQ(make(), expected) << width;
    }
    fix_cache_sizes(48 * 1024);
    EXPECT_EQ(make(), expected) << "48 KiB";
}

TEST(ThePlanFile, IsTheSameForEveryWidthAndCacheByD) {
    expect_the_same_everywhere([] { return chosen(Criterion::D); });
}
TEST(ThePlanFile, IsTheSameForEveryWidthAndCacheByA) {
    expect_the_same_everywhere([] { return chosen(Criterion::A); });
}
TEST(ThePlanFile, IsTheSameForEveryWidthAndCacheByE) {
    expect_the_same_everywhere([] { return chosen(Criterion::E); });
}
TEST(ThePlanFile, IsTheSameForEveryWidthAndCacheOfContinuousPoses) {
    expect_the_same_everywhere(planned);
}

}  // namespace
}  // namespace posewise
