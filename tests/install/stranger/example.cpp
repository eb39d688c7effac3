#include <iostream>
#include <posewise/posewise.hpp>
using namespace posewise;
int main() {
    fix_cache_sizes();  // the same digits on every CPU
    const auto campaign = io::read_campaign("campaign.yaml");
    const auto measured = io::read_measurements("measurements.csv", campaign);
    const Plan best = choose(campaign, measured_candidates(measured), {{.pose_count = 12}});
    std::cout << format_choice(best) << format(calibrate(campaign, measured));
}
