#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "posewise/report/reports.hpp"

namespace posewise {

std::string format(const std::vector<Answer>& answers) {
    constexpr std::size_t columns = 100;
    std::size_t width = 0;
    for (const Answer& one : answers) width = std::max(width, one.question.size() + 2);
    std::string text;
    for (const Answer& one : answers) {
        std::string line = fmt::format("{:{}}", one.question, width);
        std::istringstream words(one.text);
        std::size_t begin = line.size();
        for (std::string word; words >> word;) {
            if (line.size() > begin && line.size() + 1 + word.size() > columns) {
                text += line + '\n';
                line = std::string(width, ' ');
                begin = width;
            }
            line += (line.size() > begin ? " " : "") + word;
        }
        text += line + '\n';
    }
    return answers.empty() ? text : text + '\n';
}

}  // namespace posewise
