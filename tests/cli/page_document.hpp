#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace posewise::testing {

/// The document in the text of a page; fails the test where there is none.
inline nlohmann::json document_in_page(const std::string& text) {
    const std::string mark = R"(<script type="application/json" id="posewise">)";
    const auto begin = text.find(mark);
    EXPECT_NE(begin, std::string::npos) << "the page holds no document";
    if (begin == std::string::npos) return {};
    const auto end = text.find("</script>", begin);
    return nlohmann::json::parse(text.substr(begin + mark.size(), end - begin - mark.size()));
}

}  // namespace posewise::testing
