#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"

namespace posewise {
namespace {

PointSensor partly_known() {
    return PointSensor({std::nullopt, Vector3d(0.1, 0.2, 0.3), std::nullopt}, 5e-5);
}

TEST(PointSensor, PredictsTargetsInTheWorld) {
    Isometry3d flange(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ()));
    flange.translation() = Vector3d(1, 2, 3);
    VectorXd unknowns(6);
    unknowns << 0.5, 0, 0, 0, 0, 0.7;
    VectorXd expected(9);
    expected << 1, 2.5, 3, 0.8, 2.1, 3.3, 1, 2, 3.7;
    EXPECT_TRUE(partly_known().predict(flange, unknowns).isApprox(expected, 1e-15));
}

TEST(PointSensor, CountsItsTargetsInWords) {
    const PointSensor one(std::vector<std::optional<Vector3d>>{std::nullopt}, 5e-5);
    EXPECT_EQ(one.words().sentence.rfind("points of 1 target (0 known, 1 to be identified)", 0),
              0U);
    EXPECT_EQ(partly_known().words().sentence.rfind("points of 3 targets (1 known", 0), 0U);
}

TEST(PointSensor, NamesOnlyUnknownTargets) {
    const PointSensor sensor = partly_known();
    EXPECT_EQ(sensor.unknown_names(),
              (std::vector<std::string>{"target1.x", "target1.y", "target1.z",  //
                                        "target3.x", "target3.y", "target3.z"}));
    EXPECT_EQ(sensor.observation_names().size(), 9U);
    EXPECT_EQ(sensor.observation_names()[4], "p2_y");
    EXPECT_TRUE(sensor.targets().is_known(1));
    EXPECT_EQ(sensor.targets().unknown_index(1, 0), -1);
    EXPECT_EQ(sensor.targets().unknown_index(2, 0), 3);
}

TEST(PointSensor, RefusesNoTargetsAndSenselessSigma) {
    EXPECT_THROW(PointSensor({}, 1e-5), InputError);
    for (const double sigma : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(PointSensor({std::nullopt}, sigma), InputError) << sigma;
    }
    const Vector3d nowhere(0, std::numeric_limits<double>::quiet_NaN(), 0);
    EXPECT_THROW(PointSensor({nowhere}, 1e-5), InputError);
}

}  // namespace
}  // namespace posewise
