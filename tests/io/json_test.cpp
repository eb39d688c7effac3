#include <gtest/gtest.h>

#include "posewise/io/plan_file.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

TEST(ReadJson, RefusesANumberThatOverflows) {
    const testing::TemporaryFolder folder;
    const std::string path = folder.write("p.json", R"({"kind": "posewise plan", "seed": 1e999})");
    EXPECT_EQ(testing::input_error_of([&] { read_plan(path); }),
              "p.json: has a number beyond the range of numbers; must be a plan as posewise writes "
              "it");
}

TEST(ReadJson, RefusesAKeyThatStandsTwice) {
    const testing::TemporaryFolder folder;
    const std::string path = folder.write(
        "p.json", R"({"kind": "posewise plan", "poses": [{"id": "a"}, {"id": "b", "id": "c"}]})");
    EXPECT_EQ(testing::input_error_of([&] { read_plan(path); }),
              "p.json: key 'id' stands twice in one object; must stand once");
}

}  // namespace
}  // namespace posewise::io
