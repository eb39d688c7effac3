#include "report/readings_report.hpp"

#include <gtest/gtest.h>

#include "posewise/measurement/sensor.hpp"

namespace posewise {
namespace {

bool has_part(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Of a camera: an image that was turned with it fits by `px`, as stated by 4 px, another joint
/// reversed by 90 px.
ReadingSearch of_camera(double px) {
    const auto tried = [](const std::string& words, bool is_of_directions, double px) {
        return TriedReading{words, {}, is_of_directions, {0, 1e-3 * px, &pixel_units}, false};
    };
    ReadingSearch search;
    search.of = "corners";
    search.tried = {tried("width - u, height - v in place of u, v", false, px),
                    tried("as stated", true, 4), tried("q2 reversed", true, 90)};
    search.tried[2].reversed = {"q2"};
    search.tried[0].is_as_good_as_best = true;
    return search;
}

/// Two registrations of the same are never quite the same.
TEST(DescribeReadings, TakesASymmetryForNoReasonToDoubt) {
    const std::string text = detail::describe_readings(of_camera(3.9));
    EXPECT_TRUE(
        text.starts_with("joint directions: as stated; the registered robot misses the "
                         "corners by 4 px"))
        << text;
    EXPECT_TRUE(text.ends_with("otherwise by 90 px at least\n")) << text;
}

TEST(DescribeReadings, GivesTheUnitOfWhatWasRead) {
    const std::string text = detail::describe_readings(of_camera(2.1));
    EXPECT_TRUE(has_part(text, "RMS/px")) << text;
    EXPECT_FALSE(has_part(text, "mm")) << text;
    EXPECT_TRUE(has_part(text, "as stated: 4 px\nno other reading fits clearly better")) << text;
}

}  // namespace
}  // namespace posewise
