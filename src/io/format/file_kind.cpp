#include "file_kind.hpp"

#include <fmt/format.h>

#include <optional>
#include <regex>
#include <string_view>

#include "posewise/core/errors.hpp"
#include "text.hpp"

namespace posewise::detail {
namespace {

struct Recognised {
    std::optional<FileKind> kind;  ///< nothing: no kind that posewise reads here
    std::string words;
    std::string remedy;
};

/// What xacro has made a URDF of names it in a comment.
Recognised recognise_xml(std::string_view content, std::string_view head) {
    if (content.find("<xacro:") != std::string_view::npos) {
        return {std::nullopt, "a xacro file",
                "; `xacro FILE > robot.urdf` makes a URDF of it, and `posewise inspect robot.urdf "
                "--write-campaign campaign.yaml` a campaign of that"};
    }
    if (head.find("<robot") != std::string_view::npos) {
        return {std::nullopt, "a URDF",
                "; `posewise inspect FILE --write-campaign campaign.yaml` makes a campaign of it"};
    }
    return {std::nullopt, "XML", ""};
}

Recognised recognise_json(const std::string& head) {
    static const std::regex kind(R"re("kind": *"posewise (\w+)")re");
    std::smatch found;
    if (!std::regex_search(head, found, kind)) return {};  // YAML in braces, perhaps
    return {FileKind::Document, with_article(found[1].str()) + " that posewise wrote", ""};
}

/// The kind by the beginning of the file; no words where it is not plain.
Recognised recognise(std::string_view content) {
    constexpr std::size_t enough = 4096;
    if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
    const std::string head(trim(content.substr(0, enough)));
    if (head.starts_with('<')) return recognise_xml(content, head);
    if (head.starts_with('{')) return recognise_json(head);
    static const std::regex campaign(R"((^|\n)(robot|sensor) *:)");
    if (std::regex_search(head, campaign)) return {FileKind::Campaign, "a campaign file", ""};
    static const std::regex table(R"re((^|\n)"?config"?[,;\t])re");
    if (std::regex_search(head, table)) return {FileKind::Table, "a table of configurations", ""};
    return {};
}

}  // namespace

void check_file_kind(const std::string& content, const std::string& path, FileKind kind,
                     const std::string& wanted) {
    const Recognised found = recognise(content);
    if (found.words.empty() || found.kind == kind) return;
    throw input_error_at({path},
                         fmt::format("is {}; must be {}{}", found.words, wanted, found.remedy));
}

}  // namespace posewise::detail
