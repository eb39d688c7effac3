#include "options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/effort.hpp"
#include "core/text.hpp"
#include "io/format/text.hpp"

namespace posewise::cli {
namespace {

/// Whether the whole text is a number of that type, which std::from_chars reads.
template <class Number>
bool parse(const std::string& text, Number& number) {
    const char* const end = text.data() + text.size();
    const auto result = std::from_chars(text.data(), end, number);
    return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

CLI::Validator whole_number(std::uint64_t least, std::uint64_t most) {
    const std::string range = fmt::format("{} to {}", least, most);
    return CLI::Validator(
        [=](const std::string& text) {
            std::uint64_t number = 0;
            const bool has_leading_zero = text.size() > 1 && text[0] == '0';
            if (parse(text, number) && !has_leading_zero && number >= least && number <= most) {
                return std::string();
            }
            return fmt::format("is {}; must be a whole number from {}", detail::quote(text), range);
        },
        range);
}

CLI::Validator real_number(double least, double most) {
    const std::string range = fmt::format("{:g} to {:g}", least, most);
    return CLI::Validator(
        [=](const std::string& text) {
            double number = 0;
            if (parse(text, number) && number >= least && number <= most) return std::string();
            return fmt::format("is {}; must be a number from {}", detail::quote(text), range);
        },
        range);
}

CLI::Validator file_name() {
    return CLI::Validator(
        [](const std::string& name) {
            return std::string(name.empty() ? "is empty; must be the name of a file" : "");
        },
        "");
}

CLI::Option* add_ids_option(CLI::App& command, const std::string& name,
                            std::vector<std::string>& ids, const std::string& help,
                            const std::vector<std::string>& allowed) {
    const auto split = [&ids, name, allowed](const std::vector<std::string>& texts) {
        for (const std::string& text : texts) {
            for (std::string rest = text + ','; !rest.empty();) {
                const std::size_t comma = rest.find(',');
                const std::string_view id = detail::trim(std::string_view(rest).substr(0, comma));
                if (id.empty()) {
                    throw CLI::ValidationError(
                        name, "is " + detail::quote(text) +
                                  "; must be names separated by commas, none empty");
                }
                ids.emplace_back(id);
                if (!allowed.empty() && std::ranges::find(allowed, ids.back()) == allowed.end()) {
                    throw CLI::ValidationError(name, "is " + detail::quote(ids.back()) + "; " +
                                                         detail::suggest(ids.back(), allowed));
                }
                rest.erase(0, comma + 1);
            }
        }
    };
    return command.add_option_function<std::vector<std::string>>(name, split, help)
        ->expected(1, -1);
}

CLI::Option* add_effort_option(CLI::App& command, Index& starts, std::optional<double>* proof) {
    CLI::Option* const effort = command.add_option_function<std::string>(
        "--effort",
        [&starts, proof](const std::string& word) {
            detail::set_effort(*detail::find_named(detail::effort_names, word), starts, proof);
        },
        "How long searches go on: quick (one start, no proof but the first bound), usual, or "
        "thorough (40 starts, up to 20 s of proof)");
    effort->check(CLI::IsMember(detail::words_of(detail::effort_names)));
    for (const char* const name : {"--starts", "--proof"}) {
        if (CLI::Option* const other = command.get_option_no_throw(name)) effort->excludes(other);
    }
    return effort;
}

void add_prior_option(CLI::App& command, std::optional<bool>& prior,
                      const std::string& consequence) {
    // Callbacks, since a flag that is not given would set an optional, too.
    CLI::Option* const with = command.add_flag_callback(
        "--prior", [&prior] { prior = true; },
        "Sizes of robot errors are priors: the expected size of each is its standard deviation" +
            consequence + " (default: the campaign's)");
    command
        .add_flag_callback(
            "--no-prior", [&prior] { prior = false; }, "No priors, whatever the campaign says")
        ->excludes(with);
}

void add_progress_flag(CLI::App& command, bool& is_shown) {
    command.add_flag("--progress", is_shown,
                     "Show progress on standard error even if it is no terminal");
}

}  // namespace posewise::cli
