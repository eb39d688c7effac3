// What a calibration achieved: calibrates with 30 of 60 measured configurations, judges the robot
// at configurations it was not calibrated with, and writes the estimate.
//
// Run from the repository's root: build/examples/03_calibrate [ESTIMATE_FILE]
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <numeric>
#include <posewise/posewise.hpp>

using namespace posewise;

void print(const char* what, double rms) {
    std::cout << std::left << std::setw(34) << what << std::fixed << std::setprecision(4)
              << mm_per_m * rms << " mm\n";
}

int main(int argc, char** argv) try {
    const std::string path = argc > 1 ? argv[1] : "out/fanuc.estimate.json";
    std::filesystem::create_directories(std::filesystem::absolute(path).parent_path());

    fix_cache_sizes();  // the same digits on every CPU
    const io::CampaignFile campaign = io::read_campaign("designs/fanuc_r2000ic_165f/campaign.yaml");
    const std::string data = "data/fanuc_r2000ic_165f_simulated/measurements.csv";
    const Measurements measured = io::read_measurements(data, campaign);

    CalibrationOptions options;
    options.used.resize(30);
    std::iota(options.used.begin(), options.used.end(), 0);  // the first 30; the rest judges
    const Calibration calibration = calibrate(campaign, measured, options);
    if (!calibration.is_identified()) throw InputError(calibration.estimate.undetermined);
    for (const std::string& doubt : describe_doubts(calibration, data)) std::cerr << doubt << '\n';
    refuse_faults(calibration);  // throws if the estimate must not be used

    std::cout << "RMS of the distances of targets from where they are predicted\n";
    print("nominal robot", calibration.nominal.distance_rms);
    print("calibrated, its own poses", calibration.estimate.fit.distance_rms);
    print("each pose held out once", calibration.held_out.value().samples.distance_rms);
    print("30 poses never used", calibration.left_out.value().found.distance_rms);
    print("expected there", calibration.left_out.value().expected.value().total());

    const VectorXd sigmas = standard_deviations(calibration.estimate);
    const std::vector<bool> is_angle = parameter_is_angle(campaign);
    std::cout << "\nerrors of the robot and their standard deviations\n";
    const Index first = base_parameter_count(campaign);
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        const auto name = static_cast<std::size_t>(first + k);
        std::cout << std::setw(5) << calibration.estimate.names[name] << std::right << std::setw(9)
                  << 1e3 * calibration.estimate.parameters.robot[k] << " +- " << std::left
                  << 1e3 * sigmas[first + k] << (is_angle[name] ? " mrad\n" : " mm\n");
    }
    io::write_estimate(path, calibration,
                       {data, io::checksum_of(measured), campaign.path, campaign.checksum});
    std::cout << "\nestimate: " << path << '\n';
} catch (const InputError& problem) {
    std::cerr << problem.what() << '\n';
    return 1;
}
