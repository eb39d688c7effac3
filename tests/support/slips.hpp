#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

/// Valid texts with one thing changed, and what is said of them.
namespace posewise::testing {

/// The text with one part replaced by another; empty if the part is not there.
inline std::string replaced(std::string text, const std::string& part, const std::string& by) {
    const auto position = text.find(part);
    return position == std::string::npos ? "" : text.replace(position, part.size(), by);
}

/// Whether a message is `expected`, in which "[...]" stands for any words.
inline bool is_like(const std::string& message, const std::string& expected) {
    const std::string any = "[...]";
    const auto first = expected.find(any);
    if (first == std::string::npos) return message == expected;
    if (message.compare(0, first, expected, 0, first) != 0) return false;
    const std::string rest = expected.substr(first + any.size());
    const std::string next = rest.substr(0, rest.find(any));
    if (next.size() == rest.size()) {
        return message.size() >= first + next.size() && message.ends_with(next);
    }
    const auto found = message.find(next, first);
    return found != std::string::npos && is_like(message.substr(found), rest);
}

/// One change of a text, and the message that it must give, in which "[...]" stands for any words.
struct Slip {
    std::string part;
    std::string by;
    std::string message;
};

/// Each slip gives its message, with `beginning` before it: that is what `error_of` says of the
/// changed text.
template <class ErrorOf>
void expect_messages(const std::string& text, const std::vector<Slip>& slips, ErrorOf&& error_of,
                     const std::string& beginning = "") {
    for (const Slip& slip : slips) {
        SCOPED_TRACE("'" + slip.part + "' replaced by '" + slip.by.substr(0, 200) + "'");
        ASSERT_NE(text.find(slip.part), std::string::npos) << "is not in the text";
        const std::string message = error_of(replaced(text, slip.part, slip.by));
        EXPECT_TRUE(is_like(message, beginning + slip.message)) << message << "\nshould be\n"
                                                                << beginning << slip.message;
    }
}

}  // namespace posewise::testing
