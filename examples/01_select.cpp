// Which poses to measure, of those at hand: chooses 12 of 60 configurations by criterion V and
// prints them with the bound that no choice of 12 exceeds.
//
// Run from the repository's root: build/examples/01_select [CAMPAIGN MEASUREMENTS]
#include <iostream>
#include <posewise/posewise.hpp>

using namespace posewise;

int main(int argc, char** argv) try {
    const std::string campaign_path =
        argc == 3 ? argv[1] : "designs/fanuc_r2000ic_165f/campaign.yaml";
    const std::string measurements_path =
        argc == 3 ? argv[2] : "data/fanuc_r2000ic_165f_simulated/measurements.csv";

    fix_cache_sizes();  // the same digits on every CPU
    const io::CampaignFile campaign = io::read_campaign(campaign_path);
    const Measurements measured = io::read_measurements(measurements_path, campaign);

    ChoiceOptions options;
    options.criterion = Criterion::V;
    options.pose_count = 12;
    const Plan plan = choose(campaign, measured_candidates(measured), options);

    std::cout << format_choice(plan) << "\nconfiguration, joint values in deg\n";
    for (const PlannedPose& pose : plan.poses) {
        std::cout << pose.id;
        for (const double angle : pose.configuration) std::cout << '\t' << to_degrees(angle);
        std::cout << '\n';
    }
} catch (const InputError& problem) {
    std::cerr << problem.what() << '\n';
    return 1;
}
