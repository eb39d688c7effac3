#include <iostream>
#include <posewise/posewise.hpp>
using namespace posewise;
int main() {
    fix_cache_sizes();  // the digits of the program
    const auto campaign = io::read_campaign("campaign.yaml");
    std::cout << format_planning(make_plan(campaign, PlanningOptions(12)));
}
