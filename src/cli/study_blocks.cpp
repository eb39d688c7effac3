#include "study_blocks.hpp"

#include <filesystem>
#include <utility>

#include "blocks_options.hpp"
#include "files.hpp"
#include "interrupt.hpp"
#include "io/format/atomic_file.hpp"
#include "page.hpp"
#include "plot.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/report/reports.hpp"
#include "report/plot.hpp"

namespace posewise::cli {
namespace {

void check_usage(const CLI::App& command, const StudyArguments& arguments) {
    const BlocksStudyArguments& plain = arguments.plain;
    check_only(command, {"--blocks",   "--rows",   "--variable", "--subset",  "--augment",
                         "--criteria", "--poses",  "--random",   "--exclude", "--prior",
                         "--starts",   "--effort", "--seed",     "--time",    "--csv",
                         "--plot",     "--report", "--progress", "--json",    "--help"},
               "is not of a study of plain blocks (--blocks); must be left out");
    check_blocks_usage(plain.blocks, plain.sources);
    if (arguments.options.pose_counts.empty() && plain.subsets.empty()) {
        throw CLI::ValidationError("--poses", "is required with --blocks, such as 7:40");
    }
}

BlocksStudyOptions options_of(const CLI::App& command, const StudyArguments& arguments) {
    BlocksStudyOptions options;
    options.sources = arguments.plain.sources;
    options.sources.candidates = arguments.plain.blocks;
    if (!arguments.criteria.empty()) options.criteria = arguments.criteria;
    options.pose_counts = arguments.options.pose_counts;
    options.random_subsets = arguments.random_subsets.value_or(options.random_subsets);
    options.excluded = arguments.excluded;
    options.has_prior = arguments.prior.value_or(false);
    options.proof = arguments.proof;
    if (command.count("--starts") > 0 || options.proof) options.starts = arguments.options.starts;
    options.seed = arguments.seed;
    return options;
}

}  // namespace

void study_blocks(const CLI::App& command, const StudyArguments& arguments,
                  const CommonOptions& common) {
    check_usage(command, arguments);
    const BlocksStudyArguments& plain = arguments.plain;
    if (!arguments.plot.empty()) detail::check_image_path(arguments.plot);
    std::vector<std::string> inputs{plain.blocks, plain.sources.augment};
    inputs.insert(inputs.end(), plain.subsets.begin(), plain.subsets.end());
    check_outputs({}, inputs, {arguments.csv, arguments.plot, arguments.page}, common);
    BlocksStudyOptions options = options_of(command, arguments);
    PlanSources& sources = options.sources;
    io::BlocksFile file = read_blocks(plain.blocks, sources);
    sources.rows_per_block = file.rows_per_block;
    if (!sources.augment.empty()) {
        options.held_blocks = read_blocks(sources.augment, sources).blocks;
    }
    for (const std::string& path : plain.subsets) {
        options.subsets.push_back({path, io::read_subset(path, file.blocks.count())});
    }
    print_size(file.blocks, common);
    std::optional<InterruptFlag> interrupted(std::in_place);
    options.stop = {interrupted->get(), deadline_after(arguments.time_limit)};
    ProgressLine line("choosing", arguments.progress);
    options.progress = [&](const Progress& state) { line(state); };
    const BlocksStudy study = posewise::study(std::move(file.blocks), options);
    interrupted.reset();
    const std::string early = describe_early_end(study);
    if (!early.empty()) print_warning(early);
    const Printed printed{answer(study), format(study), [&] { return io::to_json(study); }};
    print(printed, common);
    if (!arguments.csv.empty()) {
        detail::write_files({{arguments.csv, "", {}, [&](const WriteText& write) {
                                  write_study_csv(study, write);
                              }}});
    }
    io::PagePart part;
    part.title = plain.blocks;
    write_page(arguments.page, std::move(part), printed, common);
    if (arguments.plot.empty()) return;
    draw_plot(arguments.plot,
              [&](const std::string& image) { return detail::study_plot_script(study, image); });
}

}  // namespace posewise::cli
