#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "files.hpp"
#include "options.hpp"
#include "posewise/io/documents.hpp"
#include "saved.hpp"

namespace posewise::cli {
namespace {

constexpr const char* report_footer = R"(
Example:
  posewise report estimate.json --out page.html
  posewise report plan_12.json plan_24.json --out plans.html
  posewise report results.sqlite --out study.html
  posewise report estimate.json export.json --out page.html

Makes one HTML file to look at from what commands have written: plans and estimates (--out), stores
of study, and what study, plan, select or export --json printed. It opens in any browser and
needs no network. Several are shown side by side. The commands themselves write the same with
--report, and then also what they print, and of plans how many candidates there were and the accuracy
of other numbers of poses.

The robot, its cell and the errors over the workspace come from the campaign file that a plan or an
estimate names, residuals from the measurements if they are still the same. What is not there any
more is left out, and said.)";

struct ReportArguments {
    std::vector<std::string> files;
    std::string out;
};

/// Where all have one name, their files tell them apart.
void name_parts(std::vector<io::PagePart>& parts, const std::vector<std::string>& files) {
    for (std::size_t k = 0; k < parts.size(); ++k) parts[k].title = files[k];
}

void report_files(const ReportArguments& arguments, const CommonOptions& common) {
    std::vector<std::string> read = arguments.files;
    check_outputs({}, read, {arguments.out}, common);
    std::vector<io::PagePart> parts;
    std::vector<std::string> files;  // of the parts
    std::string text;
    for (const std::string& path : arguments.files) {
        ShownFile shown = show_saved(path);
        text += fmt::format("{}: {}\n", detail::escape_controls(path), shown.summary);
        read.insert(read.end(), shown.read.begin(), shown.read.end());
        for (io::PagePart& part : shown.parts) {
            files.push_back(path);
            parts.push_back(std::move(part));
        }
    }
    check_outputs({}, read, {arguments.out}, common);
    if (arguments.files.size() > 1) name_parts(parts, files);
    io::write_page(arguments.out, parts, given_warnings());
    if (common.json) return print_document(io::to_json(parts));
    print(text + "page: " + detail::escape_controls(arguments.out) + '\n');
}

}  // namespace

void add_report(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<ReportArguments>();
    CLI::App* command = program.add_subcommand(
        "report", "Show saved plans, estimates, studies and exports as a page");
    command
        ->add_option("FILE", arguments->files,
                     "Plan, estimate, store of trials, or document that study or export --json "
                     "printed")
        ->required()
        ->check(file_name());
    command->add_option("-o,--out", arguments->out, "The page (HTML)")
        ->required()
        ->check(file_name());
    command->footer(report_footer);
    command->callback([arguments, &common] { report_files(*arguments, common); });
}

}  // namespace posewise::cli
