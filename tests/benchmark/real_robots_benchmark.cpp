// What a calibration of a few planned poses expects, beside what it leaves at poses held out: the
// study's splits, and how many held-out points the stated 95 % bounds hold; also of halves of
// the campaign.
//
//   real_robots_benchmark CAMPAIGN MEASUREMENTS SPLITS RANDOM [COUNT...]
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/study.hpp"

namespace posewise {
namespace {

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Share of the points of `others` within the 95 % that a calibration with `chosen` states.
double held_share(const Campaign& campaign, const Measurements& chosen,
                  const Measurements& others) {
    const Registration registration = register_base_and_targets(campaign, chosen);
    const Estimate estimate = identify(campaign, chosen, registration.parameters);
    const auto predictions = predict_errors(campaign, estimate, others.configurations);
    const RowMatrixXd squares = squared_distances(campaign, estimate.parameters, others);
    Index held = 0, seen = 0;
    for (Index i = 0; i < squares.rows(); ++i) {
        const double bound = predictions.front().each[static_cast<std::size_t>(i)].percentile95;
        for (Index t = 0; t < squares.cols(); ++t) {
            if (squares(i, t) == 0) continue;
            ++seen;
            held += std::sqrt(squares(i, t)) <= bound ? 1 : 0;
        }
    }
    return static_cast<double>(held) / static_cast<double>(seen);
}

/// The same of random halves of the campaign, each judged on the other.
void print_halves(const Campaign& campaign, const Measurements& measured, Index splits) {
    const Index all = measured.configuration_count();
    std::vector<double> held;
    for (Index split = 0; split < splits; ++split) {
        const std::vector<Index> first =
            RandomStream(1, static_cast<std::uint64_t>(split)).subset(all, all / 2);
        std::vector<Index> second(static_cast<std::size_t>(all));
        std::iota(second.begin(), second.end(), Index{0});
        std::erase_if(second, [&](Index i) { return std::ranges::binary_search(first, i); });
        held.push_back(held_share(campaign, take(measured, first), take(measured, second)));
        held.push_back(held_share(campaign, take(measured, second), take(measured, first)));
    }
    const auto [least, most] = std::minmax_element(held.begin(), held.end());
    fmt::print("halves: {:.1f} %   ({:.0f}, {:.0f})\n", 100 * mean(held), 100 * *least,
               100 * *most);
}

void run(int argc, char** argv) {
    const io::CampaignFile file = io::read_campaign(argv[1]);
    const io::MeasurementsFile measured = io::read_measurements(argv[2], file);
    StudyOptions options;
    options.seed = 1;
    options.splits = std::atoi(argv[3]);
    options.random_subsets = std::atoi(argv[4]);
    options.criteria = {Criterion::V};
    for (int i = 5; i < argc; ++i) options.pose_counts.push_back(std::atoi(argv[i]));
    print_halves(file, measured, options.splits.value());
    if (options.pose_counts.empty()) return;
    const Study result = study(file, measured, options);
    const Index all = measured.configuration_count();
    fmt::print("{}, {} splits of {} configurations; 95 %: share of held-out points within\n",
               result.campaign, result.splits, all);
    fmt::print("poses  found/mm  expected/mm  expected/found  (of splits)    ratio to random");
    fmt::print("  95 %   (least, most)\n");
    for (const StudyRow& row : result.rows) {
        std::vector<double> found, expected, ratios, held;
        for (const StudyCase& one : row.optimal) {
            if (!one.identified) continue;
            found.push_back(one.held_out.rms);
            expected.push_back(one.expected);
            ratios.push_back(one.expected / one.held_out.rms);
            const auto test =
                RandomStream(options.seed.value(), static_cast<std::uint64_t>(one.split))
                    .subset(all, result.test_count);
            held.push_back(held_share(file, take(measured, one.poses), take(measured, test)));
        }
        if (found.empty()) continue;
        const auto advantage = planned_advantage(result, row, 0);
        const auto [least, most] = std::minmax_element(held.begin(), held.end());
        const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
        fmt::print("{:5}  {:8.4f}  {:11.4f}  {:14.2f}  ({:.2f} to {:.2f})  {:15.2f}  {:4.1f}",
                   row.pose_count, 1e3 * median(found), 1e3 * median(expected),
                   median(expected) / median(found), *low, *high, advantage ? advantage->ratio : 0,
                   100 * mean(held));
        fmt::print("   ({:.0f}, {:.0f})\n", 100 * *least, 100 * *most);
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace posewise

int main(int argc, char** argv) { posewise::run(argc, argv); }
