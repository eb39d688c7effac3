// Which poses to measure, from nothing but the campaign file: plans 12 poses and 3 poses to verify
// for a robot in a cell with obstacles and a laser tracker. The poses are free of collisions and
// the tracker sees a target at each. The plan goes to a file, which is read and verified again.
//
// Run from the repository's root: build/examples/02_plan [PLAN_FILE]
#include <filesystem>
#include <iostream>
#include <posewise/posewise.hpp>

using namespace posewise;

int main(int argc, char** argv) try {
    const std::string path = argc > 1 ? argv[1] : "out/cell.plan.json";
    std::filesystem::create_directories(std::filesystem::absolute(path).parent_path());

    fix_cache_sizes();  // the same digits on every CPU
    const io::CampaignFile campaign = io::read_campaign("designs/cell_demo/campaign.yaml");

    PlanningOptions options(12);  // criterion V: mean position error over the cell
    options.verification_count = 3;
    options.pool_count = 4000;  // the default, 20 000, takes longer and is a little better
    options.starts = 4;
    options.seed = campaign.seed;
    options.sources.campaign = campaign.path;  // so that `posewise verify` finds it
    const Planning planning = make_plan(campaign, options);
    std::cout << format_planning(planning);

    io::write_plan(path, planning.plan);
    const Verification again = verify(io::read_plan(path), campaign, options);
    std::cout << path << (again.is_right() ? ": as stated\n" : ": not as stated\n")
              << format_findings(again.findings);
    return again.is_right() ? 0 : 1;
} catch (const InputError& problem) {
    std::cerr << problem.what() << '\n';
    return 1;
}
