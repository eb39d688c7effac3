#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

/// The error when line 10 of the campaign has this element; columns count from its first letter.
std::string element_error(const std::string& element) {
    const testing::TemporaryFolder folder;
    const auto path = folder.write(
        "c.yaml", testing::replaced(testing::campaign_text, "Tx 312 mm [Tx1]", element));
    const std::string message = testing::input_error_of([&] { read_campaign(path); });
    const std::string place = "c.yaml:10:";
    if (message.rfind(place, 0) != 0) return message;
    const auto colon = message.find(':', place.size());
    const int column = std::stoi(message.substr(place.size(), colon - place.size())) - 6;
    return std::to_string(column) + message.substr(colon);
}

/// Elements, and what is said of each from its column on; "[...]" stands for any words.
using Elements = std::vector<std::pair<std::string, std::string>>;

void expect_element_messages(const Elements& elements) {
    for (const auto& [element, message] : elements) {
        const std::string actual = element_error(element);
        EXPECT_TRUE(testing::is_like(actual, message)) << element << "\n"
                                                       << actual << "\nshould be\n"
                                                       << message;
    }
}

TEST(BadElement, Amounts) {
    const std::string like = "; must be like 'Tx 312 mm [Tx1]' or 'Ry -q2 + 0.5 deg [dq2]'";
    expect_element_messages({
        {"Tw 3 mm", "1: an element begins with Tx, Ty, Tz, Rx, Ry or Rz, not 'Tw'" + like},
        {"Tx", "3: an amount or a joint is missing" + like},
        {"Tx [Tx1]", "4: an amount or a joint is missing[...]"},
        {"Tx 3 mm + [Tx1]", "11: an amount or a joint is missing[...]"},
        {"Tx 312 [Tx1]", "4: a number without unit; must be in mm, m or um"},
        {"'Tx 312'", "5: a number without unit; must be in mm, m or um"},
        {"Tx 312 deg [Tx1]",
         "8: Tx is a translation, its amount cannot be in 'deg'; must be in mm, m or um"},
        {"Rx 3 mm", "6: Rx is a rotation, its amount cannot be in 'mm'; must be in[...]"},
        {"Tx 312 inch",
         "8: Tx is a translation, its amount cannot be in 'inch'; must be in mm, m or um"},
        {"Tx 1e999 mm", "4: number beyond the range of numbers"},
        {"Tx 1e308 m + 1e308 m",
         "4: the amount is too large; must be at most 1e+06 m in magnitude"},
        {"Tx 3 mm [Tx1] +", "15: '+' is not expected here[...]"},
        {"Tx 3 mm \u00b5", "9: '\u00b5' is not expected here;[...]"},
        {"Tx 3 mm 4", "9: '4' is not expected here;[...]"},
    });
}

TEST(BadElement, Joints) {
    expect_element_messages({
        {"Rx 2 q1", "6: a '*' is missing before joint 'q1'; must be like -1.5*q1"},
        {"Rx 0*q1", "4: a joint's coefficient is 0; must not be, leave the joint out"},
        {"Rx q1 + 2*p2", "11: 'p2' is no joint of the robot; did you mean 'q2'?"},
        {"Rx q1 - 2*q1",
         "11: joint 'q1' occurs twice in one element; write it once with a coefficient, like 2*q1"},
        {"Tx q1",
         "4: Tx is a translation but joint 'q1' drives the other kind before; must drive one kind, "
         "since its unit is either rad or m"},
    });
}

TEST(BadElement, Parameters) {
    const std::string name =
        ": the brackets must hold the name of one error parameter: letters, digits and "
        "underscores, like [Tx1]";
    const std::string shape =
        ": an error's function must depend on joints, like sin(q2 + 30 deg), cos(2*q2), q3 or (q3 "
        "- 0.5*q2)";
    expect_element_messages({
        {"Rx 0 [k*sin(30 deg)]", "9" + shape},
        {"Rx 0 [k*(q1 + 30 deg)]", "9" + shape},
        {"Rx 0 [k*sin(3 mm)]",
         "15: the argument of a sine is an angle, its amount cannot be in 'mm'[...]"},
        {"Rx 0 [k*sin(q9)]", "13: 'q9' is no joint of the robot; di[...]"},
        {"Rx 0 [k*sin(q1]", "15: a ')' is missing here"},
        {"Rx 0 [k*tan(q1)]", "9: 'tan' is no joint of the robot[...]"},
        {"Rx 0 [k*sin q1]", "9: 'sin' is no joint of the robot[...]"},
        {"Rx 0 [k*]", "9: an amount or a joint is missing; [...]"},
        {"Rx 0 [k*sin(q1)", "16: a ']' must stand behind parameter 'k'"},
        {"Tx 0 [Tx1] [Tx9]",
         "13: parameter 'Tx9' is a second constant error of the element, beside 'Tx1'; must be "
         "one, or depend on joints like [Tx9*sin(q1)]"},
        {"Tx 0 [Tx1] [Tx1*q1]", "13: parameter 'Tx1' occurs twice[...]"},
        {"Tx 3 mm []", "10" + name},
        {"Tx 3 mm [1x]", "10" + name},
        {"Tx 3 mm [Tx1", "13: a ']' must stand behind parameter 'Tx1'"},
        {"Tx 3 mm [Tx1 Tx2]", "14: a ']' must stand behind parameter 'Tx1'"},
        {"Tx 3 mm [dq1]",
         "10: parameter 'dq1' occurs twice, first in line 8; must have a name of its own"},
        {"Tx 3 mm [q2]",
         "10: parameter 'q2' has the name of a joint; must have one of its own, like dq2"},
    });
}

}  // namespace
}  // namespace posewise::io
