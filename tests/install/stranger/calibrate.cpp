#include <iostream>
#include <posewise/posewise.hpp>

int main() {
    const auto campaign = posewise::io::read_campaign("campaign.yaml");
    const auto measured = posewise::io::read_measurements("measurements.csv", campaign);
    std::cout << format(posewise::calibrate(campaign, measured));
}
