#include "fuzzed_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"

using namespace posewise;

namespace {

Plan planned(const Campaign& campaign) {
    const Measurements measured = simulate(campaign, {.pose_count = 3}).measurements;
    Plan plan;
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    for (Index i = 0; i < 3; ++i) {
        PlannedPose& pose = plan.poses.emplace_back();
        pose.id = "p" + std::to_string(i + 1);
        pose.configuration = measured.configurations.row(i).transpose();
    }
    return plan;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const io::CampaignFile campaign = testing::corpus_campaign("points");
    static const Plan plan = planned(campaign);
    testing::read_or_refuse(data, size, "points.txt", [](const std::string& path) {
        io::read_measurements(path, campaign, {&plan, "plan.json", "mm"});
    });
    testing::read_or_refuse(data, size, "points.txt", [](const std::string& path) {
        io::read_measurements(path, campaign, {&plan, "plan.json"});
    });
    return testing::read_or_refuse(data, size, "plan.csv",
                                   [](const std::string& path) { io::read_plan(path, campaign); });
}
