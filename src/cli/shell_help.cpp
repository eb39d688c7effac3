#include "shell_help.hpp"

#include <fmt/format.h>

#include <string_view>

#include "help.hpp"
#include "posewise/core/version.hpp"

namespace posewise::cli {
namespace {

/// `a) words="--x --y";;` for each command.
std::string bash_completion(const CLI::App& program) {
    std::string commands;
    std::string cases;
    for (const CLI::App* const command : commands_of(program)) {
        commands += ' ' + command->get_name();
        std::string options;
        for (const CLI::Option* const option : options_of(*command)) {
            for (const std::string& name : option->get_lnames()) options += " --" + name;
        }
        cases += fmt::format("    {}) words=\"{}\" ;;\n", command->get_name(), options.substr(1));
    }
    return fmt::format(
        R"(# Completion of posewise {}: source it, or keep it in the folder of completions.
_posewise() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words=""
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W "{} --help --version" -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F _posewise posewise
)",
        version, commands.substr(1), cases);
}

/// Text of roff: a backslash and a point at a line's beginning mean something else there.
std::string roff(std::string_view text) {
    std::string escaped;
    for (const char letter : text) {
        const bool begins = escaped.empty() || escaped.back() == '\n';
        if (begins && (letter == '.' || letter == '\'')) escaped += "\\&";
        escaped += letter == '\\' ? "\\e" : letter == '-' ? "\\-" : std::string(1, letter);
    }
    return escaped;
}

}  // namespace

std::string man_page(const CLI::App& program) {
    std::string page = fmt::format(
        ".TH POSEWISE 1 \"\" \"posewise {}\"\n.SH NAME\nposewise \\- {}\n.SH COMMANDS\n", version,
        roff(program.get_description()));
    for (const CLI::App* const command : commands_of(program)) {
        page +=
            fmt::format(".SS {}\n.nf\n{}.fi\n", command->get_name(), roff(full_help_of(*command)));
    }
    return page + fmt::format(".SH MORE\n.nf\n{}.fi\n", roff(program.get_footer() + '\n'));
}

std::string completion_of(const CLI::App& program, const std::string& shell) {
    return (shell == "zsh" ? "autoload -U +X bashcompinit && bashcompinit\n" : "") +
           bash_completion(program);
}

}  // namespace posewise::cli
