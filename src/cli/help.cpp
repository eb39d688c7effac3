#include "help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common.hpp"
#include "core/text.hpp"
#include "io/campaign/keys.hpp"
#include "manual.hpp"
#include "shell_help.hpp"

namespace posewise::cli {
namespace {

constexpr std::size_t page_width = 100;
constexpr std::size_t name_width = 34;

/// In the order they are shown. What stands in none is an input.
constexpr std::array groups{"Input",  "What is asked for", "Robot errors", "Earlier estimate",
                            "Search", "Judgement",         "Output",       "Rarely needed"};
enum Group : std::size_t { Input, Asked, Errors, Earlier, Search, Judged, Output, Rare };

/// The group of each option, by its long name; it means the same in every command. Rare ones are
/// named only.
constexpr std::pair<std::string_view, Group> group_of_option[] = {
    {"variable", Rare},
    {"poses", Asked},
    {"criterion", Asked},
    {"criteria", Asked},
    {"focus", Asked},
    {"target-mm", Asked},
    {"quantity", Asked},
    {"assurance", Asked},
    {"minutes", Asked},
    {"poses-at-most", Rare},
    {"robust-to", Asked},
    {"drop", Asked},
    {"verification", Asked},
    {"random-order", Rare},
    {"repeats", Asked},
    {"random", Asked},
    {"splits", Asked},
    {"holdout", Rare},
    {"models", Asked},
    {"per-group", Asked},
    {"repeat-limit", Asked},
    {"least-distance-deg", Asked},
    {"relax", Asked},
    {"simulate", Asked},
    {"trials", Asked},
    {"precision", Rare},
    {"truth", Asked},
    {"dwell", Asked},
    {"speed", Asked},
    {"handshake", Asked},
    {"reverse", Asked},
    {"dry-run", Asked},
    {"reference", Rare},
    {"every", Rare},
    {"vary", Asked},
    {"points", Rare},
    {"augment-plan", Rare},
    {"points-unit", Rare},
    {"refine", Asked},
    {"geometry", Asked},
    {"map", Output},
    {"largest-change-deg", Rare},
    {"largest-change-mm", Rare},
    {"mm-per-mrad", Rare},
    {"cartesian", Asked},
    {"tool-target", Rare},
    {"tool-rpy-deg", Rare},
    {"frame", Rare},
    {"frame-mm", Rare},
    {"frame-rpy-deg", Rare},
    {"near", Rare},
    {"workspace", Input},
    {"workspace-poses", Rare},
    {"workspace-box-mm", Input},
    {"workspace-target", Rare},
    {"prior", Errors},
    {"no-prior", Rare},
    {"sizes", Errors},
    {"free", Errors},
    {"method", Errors},
    {"loss", Errors},
    {"loss-width", Rare},
    {"model-selection", Errors},
    {"directions", Errors},
    {"alpha", Rare},
    {"max-iterations", Rare},
    {"length-error-percent", Rare},
    {"angle-error-deg", Rare},
    {"search", Rare},
    {"from", Earlier},
    {"as-prior", Earlier},
    {"moved", Earlier},
    {"only", Earlier},
    {"drift-mm", Rare},
    {"drift-offset-mrad", Rare},
    {"drift-mrad", Rare},
    {"force", Rare},
    {"pool", Search},
    {"effort", Search},
    {"starts", Rare},
    {"proof", Search},
    {"seed", Search},
    {"time", Search},
    {"threads", Rare},
    {"store", Search},
    {"shard", Rare},
    {"merge", Rare},
    {"progress", Rare},
    {"verify", Judged},
    {"verify-digits", Rare},
    {"verify-robots", Rare},
    {"folds", Judged},
    {"validate", Judged},
    {"validate-campaign", Rare},
    {"refit", Judged},
    {"limit-mm", Judged},
    {"predict", Judged},
    {"predict-out", Rare},
    {"out", Output},
    {"csv", Output},
    {"write-blocks", Output},
    {"targets", Output},
    {"report", Output},
    {"plot", Output},
    {"strict", Rare},
    {"json", Output},
    {"digits", Output},
    {"all-parameters", Output},
    {"help", Rare},
};

Group group_of(const CLI::Option& option) {
    if (option.get_positional()) return Input;
    const auto& names = option.get_lnames();
    for (const auto& [name, group] : group_of_option) {
        if (!names.empty() && names.front() == name) return group;
    }
    return Input;
}

/// In bold where people read it: on a terminal, unless they want none (https://no-color.org).
std::string bold(const std::string& text) {
    static const bool is_wanted = isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
    return is_wanted ? "\x1b[1m" + text + "\x1b[0m" : text;
}

/// Text that begins in a column, in lines that all begin there, to the page's width.
std::string wrap(const std::string& text, std::size_t indent) {
    return fmt::format(
        "{}", fmt::join(detail::wrap(text, page_width - indent), '\n' + std::string(indent, ' ')));
}

/// "N" of a whole number, "X" of any, the words where some are allowed.
std::string value_of(const CLI::Option& option) {
    if (option.get_items_expected_max() == 0) return "";
    const std::string type = option.get_type_name();
    if (const auto open = type.find('{'); open != std::string::npos) {
        std::string words = type.substr(open + 1, type.find('}') - open - 1);
        std::ranges::replace(words, ',', '|');
        return ' ' + words;
    }
    if (type.starts_with("INT") || type.starts_with("UINT")) return " N";
    if (type.starts_with("FLOAT")) return " X";
    return " ...";
}

/// "-k, --poses N"; of positional ones their name.
std::string spell(const CLI::Option& option) {
    if (option.get_positional()) return option.get_name(true);
    std::string names;
    for (const std::string& name : option.get_snames()) names += '-' + name + ", ";
    return names + "--" + option.get_lnames().front() + value_of(option);
}

/// The first clause, of what goes with another option behind that.
std::string shorten(std::string description) {
    if (description.starts_with("With --")) description.erase(0, description.find(": ") + 2);
    description[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(description[0])));
    std::size_t end = description.size();
    for (const char* const stop : {": ", "; ", " (", ". "}) {
        end = std::min(end, description.find(stop));
    }
    constexpr std::size_t most = page_width - name_width;
    if (end <= most) return description.substr(0, end);
    return description.substr(0, description.rfind(' ', most - 3)) + "...";
}

/// A footer's examples, a line each, and what comes behind them.
struct Footer {
    std::vector<std::string> examples;
    std::string notes;
};
Footer split_footer(const CLI::App& command) {
    Footer footer;
    const std::string whole = command.get_footer();
    std::string_view text = whole;
    constexpr std::string_view heading = "Example:\n";
    text.remove_prefix(std::min(text.find(heading) + heading.size(), text.size()));
    while (text.starts_with("  ")) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        footer.examples.emplace_back(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    footer.notes = text.substr(std::min(text.find_first_not_of('\n'), text.size()));
    return footer;
}

}  // namespace

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
    std::vector<const CLI::Option*> options = command.get_options();
    const auto is_group = [](const CLI::App* part) { return part->get_name().empty(); };
    for (const CLI::App* const group : command.get_subcommands(is_group)) {
        for (const CLI::Option* const own : group->get_options()) {
            if (own != group->get_help_ptr()) options.push_back(own);  // the command has one
        }
    }
    return options;
}

namespace {

std::string usage_of(const CLI::App& command) {
    std::string usage = "posewise " + command.get_name() + " [OPTIONS]";
    for (const CLI::Option* const one : options_of(command)) {
        if (!one->get_positional()) continue;
        const std::string name = one->get_name(true);
        usage += one->get_required() ? ' ' + name : " [" + name + ']';
        if (one->get_items_expected_max() > 1) usage += "...";
    }
    return usage;
}

std::string title_of(const CLI::App& command) {
    return fmt::format("{}\n\nUsage: {}\n", command.get_description(), usage_of(command));
}

std::string examples_of(const Footer& footer, std::size_t most) {
    std::string text = '\n' + bold("Example:") + '\n';
    for (std::size_t k = 0; k < std::min(most, footer.examples.size()); ++k) {
        text += footer.examples[k] + '\n';
    }
    return text;
}

/// One group's options, as `describe` has each.
template <typename Describe>
std::string list_group(const CLI::App& command, Group group, const Describe& describe) {
    std::string text;
    for (const CLI::Option* const option : options_of(command)) {
        if (group_of(*option) == group) text += describe(*option);
    }
    return text.empty() ? ""
                        : fmt::format("\n{}\n{}", bold(std::string(groups[group]) + ':'), text);
}

std::string brief_line(const CLI::Option& option) {
    const std::string name = spell(option);
    const std::size_t end = name.size() + 2;
    const std::string gap =
        end < name_width ? std::string(name_width - end, ' ') : '\n' + std::string(name_width, ' ');
    return fmt::format("  {}{}{}\n", bold(name), gap, shorten(option.get_description()));
}

std::string brief_help_of(const CLI::App& command) {
    constexpr std::size_t most_examples = 3;
    const Footer footer = split_footer(command);
    std::string text = title_of(command) + examples_of(footer, most_examples);
    for (std::size_t group = Input; group < Rare; ++group) {
        text += list_group(command, static_cast<Group>(group), &brief_line);
    }
    std::string others;
    for (const CLI::Option* const option : options_of(command)) {
        if (group_of(*option) == Rare) others += " --" + option->get_lnames().front();
    }
    if (!others.empty()) text += "\nAlso: " + wrap(others.substr(1), 6) + '\n';
    return text + fmt::format("\nAll of it in full: posewise help {}\n", command.get_name());
}

/// What an option's value may be, and which others it goes with.
std::string rules_of(const CLI::Option& option) {
    std::vector<std::string> rules;
    const std::string type = option.get_type_name();
    if (const auto colon = type.find(':'); colon != std::string::npos && type[colon + 1] != '{') {
        rules.push_back(type.substr(colon + 1));
    }
    if (!option.get_default_str().empty()) rules.push_back("default " + option.get_default_str());
    const auto list = [&](const char* words, const std::set<CLI::Option*>& others) {
        std::string names;
        for (const CLI::Option* const other : others) names += ' ' + other->get_name();
        if (!names.empty()) rules.push_back(words + names);
    };
    list("needs", option.get_needs());
    list("not with", option.get_excludes());
    return rules.empty() ? "" : fmt::format(" [{}]", fmt::join(rules, "; "));
}

std::string full_entry(const CLI::Option& option) {
    constexpr std::size_t indent = 6;
    return fmt::format("  {}\n{:<{}}{}\n", bold(spell(option)), "", indent,
                       wrap(option.get_description() + rules_of(option), indent));
}

}  // namespace

std::string full_help_of(const CLI::App& command) {
    const Footer footer = split_footer(command);
    std::string text = title_of(command) + examples_of(footer, footer.examples.size());
    if (!footer.notes.empty()) text += '\n' + footer.notes + '\n';
    for (std::size_t group = Input; group <= Rare; ++group) {
        text += list_group(command, static_cast<Group>(group), &full_entry);
    }
    return text;
}

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

namespace {

class BriefHelp : public CLI::Formatter {
  public:
    std::string make_help(const CLI::App* app, std::string name,
                          CLI::AppFormatMode mode) const override {
        return app->get_parent() == nullptr ? Formatter::make_help(app, std::move(name), mode)
                                            : brief_help_of(*app);
    }
};

std::string topics(const CLI::App& program) {
    std::string text =
        "posewise help TOPIC prints one of these, or explains a key of campaign "
        "files.\n\nCommands:\n";
    for (const CLI::App* const command : commands_of(program)) {
        text += fmt::format("  {:<21} {}\n", command->get_name(), command->get_description());
    }
    text += "\nSections of the manual:\n";
    std::size_t width = 0;
    for (const ManualSection& section : manual_sections()) {
        width = std::max(width, section.topic.size());
    }
    for (const ManualSection& section : manual_sections()) {
        text += fmt::format("  {:<{}}  {}\n", section.topic, width, section.title);
    }
    return text;
}

/// The comments of the manual's source are not for its readers.
std::string without_comments(std::string_view text) {
    std::string kept;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        const std::string_view line = text.substr(begin, end - begin);
        if (!line.starts_with("<!--")) kept += line;
        begin = end;
    }
    return kept;
}

/// What the manual says of a key of campaign files, wherever it may stand; empty if nowhere.
std::string explain_key(const std::string& name) {
    std::string text;
    for (const detail::YamlKeys* const keys : detail::keys::all()) {
        for (const detail::YamlKey& key : keys->keys) {
            const detail::NameWithUnit named = detail::split_unit(key.key);
            if (key.key != name && named.stem != name) continue;
            text += fmt::format("{} ({}{}{})\n    {}\n", key.key, keys->name,
                                key.of.empty() ? "" : ", of ", key.of, key.means);
            if (!key.absent.empty()) text += fmt::format("    default: {}\n", key.absent);
            if (!key.example.empty()) text += fmt::format("    example: {}\n", key.example);
        }
    }
    return text;
}

void print_help(const CLI::App& program, const std::string& topic) {
    if (topic.empty()) return print(topics(program));
    std::vector<std::string> names;
    for (const CLI::App* const command : commands_of(program)) {
        if (command->get_name() == topic) return print(full_help_of(*command));
        names.push_back(command->get_name());
    }
    for (const ManualSection& section : manual_sections()) {
        if (section.topic == topic) return print(without_comments(section.text));
        names.push_back(section.topic);
    }
    if (const std::string key = explain_key(topic); !key.empty()) return print(key);
    throw CLI::ValidationError(
        "TOPIC", detail::quote(topic) + " is no topic; " + detail::suggest(topic, names));
}

}  // namespace

std::shared_ptr<CLI::FormatterBase> make_brief_help() { return std::make_shared<BriefHelp>(); }

void add_help_commands(CLI::App& program) {
    auto topic = std::make_shared<std::string>();
    auto is_man = std::make_shared<bool>(false);
    CLI::App* const help = program.add_subcommand("help", "Explain a command or a topic in full");
    help->add_option("TOPIC", *topic,
                     "A command, a section of the manual or a key of campaign files (default: "
                     "lists\nthe first two)");
    help->footer(
        "\nExample:\n  posewise help plan\n  posewise help cell\n  posewise help model_error_mm\n");
    help->add_flag("--man", *is_man, "Print the man page");
    help->callback([&program, topic, is_man] {
        if (*is_man) return print(man_page(program));
        print_help(program, *topic);
    });

    auto shell = std::make_shared<std::string>();
    CLI::App* const completion =
        program.add_subcommand("completion", "Print what completes commands in a shell");
    completion->add_option("SHELL", *shell, "bash or zsh")
        ->required()
        ->check(CLI::IsMember({"bash", "zsh"}));
    completion->footer(
        "\nExample:\n  posewise completion bash > "
        "~/.local/share/bash-completion/completions/posewise\n");
    completion->callback([&program, shell] { print(completion_of(program, *shell)); });
}

}  // namespace posewise::cli
