#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "../../src/io/format/atomic_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

/// The measured campaign of the FANUC R-2000iC/165F, which is not part of the repository.
class FanucMeasurements : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(folder_)) {
            GTEST_SKIP() << "needs the measured campaign in " << folder_
                         << " (set POSEWISE_REAL_DATA)";
        }
        file_ = read_campaign(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    }

    const std::string folder_ = real_data() + "/fanuc_r2000ic_165f";
    const std::string csv_ = folder_ + "/measurements.csv";
    const std::string mat_ = folder_ + "/calibration_dataset.mat";
    CampaignFile file_;
};

TEST_F(FanucMeasurements, AreTenSamplesOfEachOf24Configurations) {
    const Measurements measurements = read_measurements(csv_, file_);
    EXPECT_EQ(measurements.configuration_count(), 24);
    EXPECT_EQ(measurements.observations.rows(), 240);
    EXPECT_EQ(measurements.observations.cols(), 9);
    for (Index i = 0; i < 24; ++i) EXPECT_EQ(measurements.sample_count(i), 10);
    EXPECT_NEAR(repeatability(*file_.sensor, measurements)->length, 0.05185e-3, 0.00001e-3);
}

TEST_F(FanucMeasurements, AreTheSameInCsvAndMatlab) {
    const Measurements csv = read_measurements(csv_, file_);
    const Measurements mat = read_measurements(mat_, file_);
    EXPECT_EQ(csv.ids, mat.ids);
    EXPECT_EQ(csv.first_sample, mat.first_sample);
    EXPECT_LT((csv.configurations - mat.configurations).cwiseAbs().maxCoeff(), 1e-8);
    EXPECT_LT((csv.observations - mat.observations).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_F(FanucMeasurements, LieWithinTheLimitsOfTheDesign) {
    const Measurements measurements = read_measurements(csv_, file_);
    for (Index j = 0; j < 6; ++j) {
        const Joint& joint = file_.robot.joints()[static_cast<std::size_t>(j)];
        EXPECT_GE(measurements.configurations.col(j).minCoeff(), joint.lower) << joint.name;
        EXPECT_LE(measurements.configurations.col(j).maxCoeff(), joint.upper) << joint.name;
    }
}

TEST_F(FanucMeasurements, AreRefusedIfTheMatlabFileIsCutShort) {
    const std::string whole = read_file(mat_);
    const testing::TemporaryFolder folder;
    for (std::size_t size = 0; size < whole.size(); size += 97) {
        const auto path = folder.write("cut.mat", whole.substr(0, size));
        EXPECT_NE(testing::input_error_of([&] { read_measurements(path, file_); }), "no error")
            << size << " of " << whole.size() << " bytes";
    }
}

}  // namespace
}  // namespace posewise::io
