#include "file_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
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

Recognised recognise_json(std::string_view head) {
    constexpr std::string_view key = "\"kind\":";
    constexpr std::string_view ours = "\"posewise ";
    const std::size_t at = head.find(key);
    if (at == std::string_view::npos) return {};  // YAML in braces, perhaps
    head.remove_prefix(at + key.size());
    head.remove_prefix(std::min(head.find_first_not_of(' '), head.size()));
    if (!head.starts_with(ours)) return {};
    head.remove_prefix(ours.size());
    const std::string word(head.substr(0, head.find('"')));
    return {FileKind::Document, with_article(word) + " that posewise wrote", ""};
}

/// Whether a line begins with the word, and one of these characters after `between`.
bool has_line(std::string_view text, std::string_view word, char between, std::string_view after) {
    for (std::size_t at = text.find(word); at != std::string_view::npos;
         at = text.find(word, at + 1)) {
        if (at > 0 && text[at - 1] != '\n') continue;
        const std::size_t next = text.find_first_not_of(between, at + word.size());
        if (next != std::string_view::npos && after.find(text[next]) != std::string_view::npos) {
            return true;
        }
    }
    return false;
}

/// The kind by the beginning of the file; no words where it is not plain.
Recognised recognise(std::string_view content) {
    constexpr std::size_t enough = 4096;
    if (content.starts_with("\xEF\xBB\xBF")) content.remove_prefix(3);
    const std::string head(trim(content.substr(0, enough)));
    if (head.starts_with('<')) return recognise_xml(content, head);
    if (head.starts_with('{')) return recognise_json(head);
    if (has_line(head, "robot", ' ', ":") || has_line(head, "sensor", ' ', ":")) {
        return {FileKind::Campaign, "a campaign file", ""};
    }
    if (has_line(head, "config", '"', ",;\t") || has_line(head, "\"config", '"', ",;\t")) {
        return {FileKind::Table, "a table of configurations", ""};
    }
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
