#include "../../src/io/measurements/groups_file.hpp"

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

class ReadGroups : public ::testing::Test {
  protected:
    std::string write(const std::string& text) const { return folder_.write("g.csv", text); }
    std::string error_of(const std::string& text) const {
        return testing::input_error_of([&] { read_groups(write(text), ids_); });
    }

    testing::TemporaryFolder folder_;
    const std::vector<std::string> ids_{"a", "b", "c"};
};

TEST_F(ReadGroups, GivesLabelsInTheOrderOfTheIds) {
    EXPECT_EQ(read_groups(write("config,group\nc,left\na,right\nb,left\n"), ids_),
              (std::vector<Index>{1, 0, 0}));
    EXPECT_EQ(read_groups(write("group,config\n1,a\n2,b\n2,c\n"), ids_),
              (std::vector<Index>{0, 1, 1}));
}

TEST_F(ReadGroups, SaysWhereAFileIsWrong) {
    EXPECT_EQ(error_of(""), "g.csv: is empty; must begin with config,group");
    EXPECT_EQ(error_of("id,group\n"), "g.csv:1:1: header must be config,group");
    EXPECT_EQ(error_of("config,group\na\n"), "g.csv:2:1: row must have 2 fields");
    EXPECT_EQ(error_of("config,group\nd,1\n"), "g.csv:2:1: 'd' is not among the candidates");
    EXPECT_EQ(error_of("config,group\na,1\na,2\n"), "g.csv:3:1: 'a' occurs twice; keep one");
    EXPECT_EQ(error_of("config,group\na,1\nc,2\n"),
              "g.csv: has no group for 'b'; must have one for each candidate");
}

}  // namespace
}  // namespace posewise::io
