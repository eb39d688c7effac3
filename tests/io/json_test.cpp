#include <gtest/gtest.h>

#include "posewise/io/result_files.hpp"
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

TEST(ReadJson, RefusesDeepNesting) {
    const testing::TemporaryFolder folder;
    const auto error_of = [&](std::size_t depth) {
        const std::string path = folder.write(
            "p.json", R"({"kind": "posewise plan", "format": 2, "x": )" + std::string(depth, '[') +
                          '1' + std::string(depth, ']') + R"(, "a": 1})");
        return testing::input_error_of([&] { read_plan(path); });
    };
    EXPECT_EQ(error_of(49), "p.json: poses: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_of(50), "p.json: is nested more than 50 deep; must be less");
    EXPECT_EQ(error_of(100000), error_of(50));
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
