#include "manual.hpp"

#include <algorithm>
#include <array>
#include <cctype>

// Put in by the assembler as they are, see src/io/page_template.cpp.
#define POSEWISE_MANUAL(name, file)                                                  \
    __asm__(".pushsection .rodata\n.globl posewise_manual_" #name                    \
            "\n.hidden posewise_manual_" #name "\nposewise_manual_" #name            \
            ":\n.incbin \"" POSEWISE_DESIGNS "/" file "\"\n.byte 0\n.popsection\n"); \
    extern "C" [[gnu::visibility("hidden")]] const char posewise_manual_##name[];

POSEWISE_MANUAL(campaign, "README.md")
POSEWISE_MANUAL(studies, "studies.md")
POSEWISE_MANUAL(json, "json.md")
POSEWISE_MANUAL(page, "page.md")
POSEWISE_MANUAL(programs, "programs.md")

namespace posewise::cli {
namespace {

std::string topic_of(std::string_view title) {
    std::string topic;
    for (const char letter : title.substr(0, title.find(','))) {
        topic += letter == ' '
                     ? '-'
                     : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    return topic;
}

/// From one heading to the next; the first is of the whole manual.
void add_sections(std::string_view manual, const std::string& name, const std::string& prefix,
                  std::vector<ManualSection>& sections) {
    std::size_t begin = 0;
    while (begin < manual.size()) {
        const std::size_t found = manual.find("\n#", begin + 1);
        const std::size_t end = found == std::string_view::npos ? manual.size() : found + 1;
        const std::string_view text = manual.substr(begin, end - begin);
        std::string_view title = text.substr(0, text.find('\n'));
        title.remove_prefix(std::min(title.find_first_not_of("# "), title.size()));
        sections.push_back({begin == 0 ? name : prefix + topic_of(title), title, text});
        begin = end;
    }
}

}  // namespace

std::vector<ManualSection> manual_sections() {
    std::vector<ManualSection> sections;
    add_sections(posewise_manual_campaign, "campaign", "", sections);
    add_sections(posewise_manual_studies, "studies", "", sections);
    add_sections(posewise_manual_json, "json", "json-", sections);
    add_sections(posewise_manual_page, "page", "page-", sections);
    add_sections(posewise_manual_programs, "programs", "programs-", sections);
    return sections;
}

}  // namespace posewise::cli
