#include <gtest/gtest.h>

#include "../../src/io/format/atomic_file.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

class WeightsFile : public ::testing::Test {
  protected:
    WeightsFile() {
        design_.campaign = "crane";
        design_.request.criterion = Criterion::D;
        design_.request.seed = 1;
        design_.request.pose_count = 1;
        design_.weights = {{"second, \"the\" heavy", 2.0 / 3}, {"b", 1.0 / 3}};
    }
    testing::TemporaryFolder folder_;
    ApproximateDesign design_;
};

TEST_F(WeightsFile, IsCsvWithDigitsEnoughToReadThemBack) {
    write_weights(folder_.path("w.csv"), design_);
    EXPECT_EQ(detail::read_file(folder_.path("w.csv")),
              "config,weight\n\"second, \"\"the\"\" heavy\",0.6666666666666666\nb,"
              "0.3333333333333333\n");
}

TEST_F(WeightsFile, IsTheJsonDocumentByItsName) {
    write_weights(folder_.path("w.json"), design_);
    EXPECT_EQ(detail::read_file(folder_.path("w.json")), to_json(design_));
}

TEST_F(WeightsFile, IsRefusedByAnotherName) {
    EXPECT_EQ(testing::input_error_of([&] { write_weights(folder_.path("w.txt"), design_); }),
              "w.txt: must end in .csv or .json");
}

}  // namespace
}  // namespace posewise::io
