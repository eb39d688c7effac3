// How many poses are enough: calibrates with 8, 12 and 16 poses, chosen by criterion V and at
// random, and judges each calibration on the same poses held out. 5 splits of 60 configurations.
//
// Run from the repository's root: build/examples/04_study
#include <iomanip>
#include <iostream>
#include <posewise/posewise.hpp>

using namespace posewise;

/// An RMS in mm; "-" where too many subsets do not identify the model.
void print(std::optional<double> rms) {
    std::cout << std::setw(12);
    if (rms) {
        std::cout << mm_per_m * *rms;
    } else {
        std::cout << '-';
    }
}

int main() try {
    fix_cache_sizes();  // the same digits on every CPU
    const io::CampaignFile campaign = io::read_campaign("designs/fanuc_r2000ic_165f/campaign.yaml");
    const Measurements measured =
        io::read_measurements("data/fanuc_r2000ic_165f_simulated/measurements.csv", campaign);

    StudyOptions options;
    options.criteria = {Criterion::V};
    options.pose_counts = {8, 12, 16};
    options.splits = 5;
    options.holdout = 0.5;  // part of the configurations that a split judges on
    options.random_subsets = 50;
    const Study result = study(campaign, measured, options);
    if (!result.undetermined.empty()) throw InputError(result.undetermined);

    std::cout << "RMS position error over " << result.test_count << " poses held out, mm\n"
              << "poses   planned    expected    random: 10 %     50 %        90 %     ratio\n"
              << std::fixed << std::setprecision(4);
    for (const StudyRow& row : result.rows) {
        std::cout << std::setw(5) << row.pose_count;
        print(held_out_quantile(row.optimal, 0.5));
        print(median_expected(row.optimal));
        for (const double p : {0.1, 0.5, 0.9}) print(held_out_quantile(row.random, p));
        const std::optional<Advantage> advantage = planned_advantage(result, row, 0);
        if (advantage) {
            std::cout << std::setprecision(2) << "  " << advantage->ratio << " ("
                      << advantage->lower << " to " << advantage->upper << "), "
                      << verdict_name(verdict_of(*advantage)) << std::setprecision(4);
        }
        std::cout << '\n';
    }
} catch (const InputError& problem) {
    std::cerr << problem.what() << '\n';
    return 1;
}
