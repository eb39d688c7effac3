#include <fmt/format.h>

#include <algorithm>

#include "core/text.hpp"
#include "posewise/report/reports.hpp"

namespace posewise {

std::string format(const std::vector<Answer>& answers) {
    constexpr std::size_t columns = 100;
    std::size_t width = 0;
    for (const Answer& one : answers) width = std::max(width, one.question.size() + 2);
    std::string text;
    for (const Answer& one : answers) {
        std::string head = fmt::format("{:{}}", one.question, width);
        for (const std::string& line : detail::wrap(one.text, columns - width)) {
            text += head + line + '\n';
            head.assign(width, ' ');
        }
    }
    return answers.empty() ? text : text + '\n';
}

}  // namespace posewise
