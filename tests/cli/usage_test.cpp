#include <algorithm>
#include <sstream>

#include "program.hpp"

namespace posewise::testing {
namespace {

class Usage : public Program {};

const std::string commands[] = {"inspect", "indices", "select", "plan",     "verify", "calibrate",
                                "export",  "correct", "study",  "simulate", "program"};

TEST_F(Usage, VersionIsThatOfTheProject) {
    EXPECT_EQ(run_well("--version"), std::string("posewise ") + stated_version() + '\n');
}

TEST_F(Usage, HelpNamesEveryCommand) {
    const std::string help = run_well("--help");
    for (const auto& command : commands) {
        EXPECT_NE(help.find("\n  " + command), std::string::npos) << command;
    }
}

TEST_F(Usage, HelpOfEveryCommandHasAnExample) {
    for (const auto& command : commands) {
        const std::string help = run_well(command + " --help");
        EXPECT_NE(help.find("Example:\n  posewise " + command), std::string::npos) << help;
    }
}

TEST_F(Usage, HelpNamesEachOptionOnceAndSaysWhatItIs) {
    for (const auto& command : commands) {
        const std::string help = run_well(command + " --help");
        const std::size_t at = help.find(" --help");
        EXPECT_NE(at, std::string::npos) << help;
        EXPECT_EQ(help.find(" --help", at + 1), std::string::npos) << help;
        // A description that begins with the values would be cut to them.
        for (const char* values :
             {" Learned", " What counts", " Base, targets", "  O1, o2", " Lm,"}) {
            EXPECT_EQ(help.find(values), std::string::npos) << help;
        }
    }
}

TEST_F(Usage, HelpOfEveryCommandFitsAScreen) {
    for (const auto& command : commands) {
        const std::string help = run_well(command + " --help");
        EXPECT_LE(std::count(help.begin(), help.end(), '\n'), 60) << command;
        std::istringstream lines(help);
        for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
    }
}

TEST_F(Usage, HelpExplainsEveryOptionAndEverySectionOfTheManual) {
    const std::string topics = run_well("help");
    EXPECT_NE(topics.find("\n  plan "), std::string::npos) << topics;
    EXPECT_NE(topics.find("\n  cell "), std::string::npos) << topics;
    EXPECT_NE(run_well("help plan").find("\n  --drift-mrad X\n"), std::string::npos);
    // Options of which one is asked for.
    EXPECT_NE(run_well("simulate --help").find("\n  -k, --poses "), std::string::npos);
    EXPECT_NE(run_well("help select").find("--candidates "), std::string::npos);
    EXPECT_EQ(run_well("help cell").rfind("## cell\n", 0), 0u);
    const Outcome unknown = run("help plans");
    EXPECT_EQ(unknown.code, 2);
    EXPECT_NE(unknown.err.find("'plans' is no topic; did you mean 'plan'?"), std::string::npos)
        << unknown.err;
}

TEST_F(Usage, CompletionIsAScriptThatKnowsTheOptions) {
    for (const std::string shell : {"bash", "zsh"}) {
        write_text("completion.sh", run_well("completion " + shell));
        EXPECT_NE(text_of("completion.sh").find("--target-mm"), std::string::npos);
    }
    write_text(
        "try.sh",
        "set -e\nsource completion.sh 2>/dev/null || true\nCOMP_WORDS=(posewise plan --target-)\n"
        "COMP_CWORD=2\n_posewise\necho \"${COMPREPLY[*]}\"\n");
    write_text("completion.sh", run_well("completion bash"));
    EXPECT_EQ(run_line("bash try.sh > .out 2> .err").out, "--target-mm\n");
}

/// Arguments, and words of what is said of them.
const std::vector<std::pair<std::string, std::string>> wrong_usage{
    {"", "A subcommand is required"},
    {"calibrated", "'calibrated' is no command; did you mean 'calibrate'?"},
    {"inspect", "CAMPAIGN is required"},
    {"inspect a.yaml --nonsense", "--nonsense"},
    {"select a.yaml -m b.csv", "--poses is required"},
    {"select a.yaml -m b.csv -k 6 --criterion o6",
     "--criterion: 'o6' is no criterion; must be one of o1, "},
    {"select a.yaml -m b.csv -k -1", "--poses: is '-1'; must be a whole number from 1 to 1000000"},
    {"select a.yaml -m b.csv -k six",
     "--poses: is 'six'; must be a whole number from 1 to 1000000"},
    {"select a.yaml -m b.csv -k 6 -o p -o q", "posewise: --out: is given twice; keep one; see"},
    {"select a.yaml -k 6", "[-m,--measurements,--candidates,--random,--blocks] is required"},
    {"select -m b.csv -k 6", "CAMPAIGN: is required (but for --blocks)"},
    {"select a.yaml -m b.csv --random 9 -k 6", "is required and 2 were given"},
    {"select --blocks b.csv -k 6", "--rows: is required with --blocks"},
    {"select a.yaml --blocks b.csv --rows 3 -k 6", "CAMPAIGN: must be left out with --blocks"},
    {"select a.yaml -m b.csv --rows 3 -k 6", "--rows: goes with --blocks only"},
    {"select --blocks b.csv --rows 3 -k 6 --focus robot", "--focus: needs a robot"},
    {"select --blocks b.csv --rows 3 -k 6 --least-distance-deg 4",
     "--least-distance-deg: needs a robot"},
    {"select a.yaml -m b.csv -k 6 --groups g.csv", "--groups: and --per-group need each other"},
    {"select a.yaml -m b.csv -k 6 --per-group 2", "--groups: and --per-group need each other"},
    {"select a.yaml -m b.csv -k 6 --relax --groups g.csv --per-group 2",
     "--groups: cannot be kept by weights, --relax"},
    {"select a.yaml -m b.csv -k 6 --relax --least-distance-deg 9",
     "--least-distance-deg: cannot be kept by weights, --relax"},
    {"select a.yaml -m b.csv -k 6 --relax --starts 9",
     "--starts: are of a search, which --relax does not need"},
    {"select a.yaml -m b.csv -k 6 --relax -o plan.txt",
     "--out: must end in .csv or .json with --relax"},
    {"select a.yaml -m b.csv -k 6 --json --digits 9", "--digits excludes --json"},
    {"indices a.yaml -m b.csv --digits 18",
     "--digits: is '18'; must be a whole number from 1 to 17"},
    {"select a.yaml -m b.csv -k 6 --time 0",
     "--time: is '0'; must be a number from 0.001 to 1e+09"},
    {"select a.yaml -m b.csv -k 6 --exclude a,,b",
     "--exclude: is 'a,,b'; must be names separated by commas, none empty"},
    {"select a.yaml -m b.csv -k 6 --exclude ,",
     "--exclude: is ','; must be names separated by commas, none empty"},
    {"calibrate a.yaml -m b.csv --free , --loss huber",
     "--free: is ','; must be names separated by commas, none empty"},
    {"plan a.yaml -k 6 --from e.json --moved bass --as-prior",
     "--moved: is 'bass'; did you mean 'base'?"},
    {"select a.yaml -m b.csv -k 6 -o ''", "--out: is empty; must be the name of a file"},
    {"select --blocks b.csv --rows 3 -k 6 --repeats 2", "--repeats: needs a robot"},
    {"select --blocks b.csv --rows 3 -k 6 --variable J",
     "--variable: goes with --blocks and a .mat or .npz file only"},
    {"plan a.yaml -k 6 -o ''", "--out: is empty; must be the name of a file"},
    {"plan a.yaml -k 6 --workspace w.csv --workspace-poses 9",
     "--workspace excludes --workspace-poses"},
    {"plan a.yaml -k 6 --workspace w.csv --workspace-box-mm 0,0,0,1,1,1",
     "--workspace excludes --workspace-box-mm"},
    {"plan a.yaml --plan p.json --drop p1,",
     "--drop: is 'p1,'; must be names separated by commas, none empty"},
    {"verify", "PLAN is required"},
    {"export a.yaml b.json",
     "--urdf, --dh, --ur-kinematics, --mujoco, --robodk, --map, --offsets or --camera is required"},
    {"export a.yaml b.json --dh c --geometry best", "--geometry: best not in {nearest,estimate}"},
    {"program a.json", "--for is required"},
    {"program a.json --for fanuc", "--out is required"},
    {"program a.json --for robot -o a.ls", "--for: robot"},
    {"program a.json --for fanuc -o a.ls --reverse", "--reverse: needs --repeats 2"},
    {"program a.json --for fanuc --read a.ls --dwell 2", "--read excludes --dwell"},
    {"program a.json --for fanuc -o a.ls --speed 101", "--speed"},
    {"correct a.yaml b.json", "--poses is required"},
    {"correct a.yaml b.json --poses c.csv --tool-mm 1 2", "--tool-mm: 3 required"},
    {"correct a.yaml b.json --poses c.csv --tool-mm 1,2", "--tool-mm: 3 required"},
    {"correct a.yaml b.json --poses c.csv --base robot", "--base: robot"},
    {"correct a.yaml b.json --poses c.csv --largest-change-deg 0",
     "--largest-change-deg: is '0'; must be a number from 1e-06 to 180"},
    {"calibrate a.yaml -m b.csv --method newton", "--method: newton"},
    {"calibrate a.yaml -m b.csv --alpha 0", "--alpha: is '0'; must be a number from 1e-06 to 1"},
    {"calibrate a.yaml -m b.csv --alpha 0.5", "--alpha: needs --method two-step"},
    {"calibrate a.yaml -m b.csv --starts 5", "--starts: needs --method global"},
    {"calibrate a.yaml -m b.csv --method two-step --angle-error-deg 9",
     "--angle-error-deg: needs --method global"},
    {"calibrate a.yaml -m b.csv --loss bisquare", "--loss: bisquare"},
    {"calibrate a.yaml -m b.csv --loss huber --method two-step",
     "--loss: needs --method lm; the others know squares only"},
    {"calibrate a.yaml -m b.csv --loss huber --loss-width 0",
     "--loss-width: is '0'; must be a number from 0.1 to 1e+06"},
    {"calibrate a.yaml -m b.csv --loss-width 2", "--loss-width: needs --loss huber or cauchy"},
    {"calibrate a.yaml -m b.csv --sizes learned --method global",
     "--sizes: learned needs --method lm"},
    {"calibrate a.yaml -m b.csv --sizes learned --no-prior", "--sizes: learned needs priors"},
    {"calibrate a.yaml -m b.csv --model-selection --method two-step",
     "--model-selection: needs --method lm"},
    {"calibrate a.yaml -m b.csv --model-selection --folds 0",
     "--model-selection: needs --folds of 2 or more"},
    {"study a.yaml -m b.csv --poses 5-9",
     "--poses: '5-9' is not a pose count; must be like 5:24 or 6,9,12"},
    {"study a.yaml -m b.csv --poses 9:5",
     "--poses: is '9:5'; the first must not be above the last"},
    {"study a.yaml -m b.csv --poses ,",
     "--poses: '' is not a pose count; must be like 5:24 or 6,9,12"},
    {"study a.yaml -m b.csv --criteria d,q",
     "--criteria: 'q' is no criterion; must be one of o1, "},
    {"simulate a.yaml -k 5", "--out is required"},
    {"simulate a.yaml -k 5 --seed -1 --out a.csv",
     "--seed: is '-1'; must be a whole number from 0 to 18446744073709551615"},
    {"study a.yaml", "needs measured configurations (-m), --simulate or --blocks"},
    {"simulate a.yaml -k 5 -o a.csv --seed -1",
     "--seed: is '-1'; must be a whole number from 0 to 18446744073709551615"},
    {"simulate a.yaml -k 5 -o a.csv --seed 18446744073709551616",
     "--seed: is '18446744073709551616'; must be a whole number from 0 to "
     "18446744073709551615"},
    {"simulate a.yaml -k 0x5 -o a.csv",
     "--poses: is '0x5'; must be a whole number from 1 to 100000"},
    {"simulate a.yaml -k ' 5' -o a.csv",
     "--poses: is ' 5'; must be a whole number from 1 to 100000"},
    {"simulate a.yaml -k 5 -o ''", "--out: is empty; must be the name of a file"},
    {"inspect ''", "CAMPAIGN: is empty; must be the name of a file"},
    {"calibrate a.yaml -m b.csv --alpha nan",
     "--alpha: is 'nan'; must be a number from 1e-06 to 1"},
    {"calibrate a.yaml -m b.csv --folds ''",
     "--folds: is ''; must be a whole number from 0 to 1000000"},
    {"study a.yaml -m b.csv -c ,", "--criteria: '' is no criterion; must be one of o1, "},
    {"select a.yaml -m b.csv -k 8 -c o6", "--criterion: 'o6' is no criterion; must be one of o1, "},
    {"study a.yaml -m b.csv --models full,rigid",
     "--models: is 'rigid'; must be full, geometric, offsets, stated or none"},
    {"study a.yaml -m b.csv -k 8:6", "--poses: is '8:6'; the first must not be above the last"},
    {"study absent.yaml --simulate -k 6,10 --merge a.sqlite --store b.sqlite",
     " is not looked at where --merge puts stores together"},
    {"study a.yaml -m b.csv --splits 0 --holdout 0.4", "--holdout: is of splits"},
    {"select a.yaml -m b.csv -k 8 --relax --proof 5", "--proof: is of a choice"},
    {"select a.yaml --random 20 -k 8 --force", "--force: is of an estimate or of measurements"},
    {"calibrate a.yaml -m b.csv --json --all-parameters", "--all-parameters excludes --json"},
};

TEST_F(Usage, EveryCommandRefusesNoThreads) {
    for (const auto& command : commands) {
        for (const std::string count : {"0", "-2", "two"}) {
            const Outcome outcome = run(command + " --threads " + count);
            EXPECT_EQ(outcome.code, 2) << command;
            EXPECT_EQ(outcome.err, "posewise: --threads: is '" + count +
                                       "'; must be a whole number from 1 to 1024; see posewise " +
                                       command + " --help\n");
        }
    }
}

/// One line that ends with where to look, whatever is wrong; nothing is written.
TEST_F(Usage, WrongUsageExitsWithTwo) {
    for (const auto& [arguments, words] : wrong_usage) {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        const std::string command = arguments.substr(0, arguments.find(' '));
        const bool is_one = std::count(std::begin(commands), std::end(commands), command) > 0;
        const std::string where = "; see posewise " + (is_one ? command + ' ' : "") + "--help\n";
        EXPECT_TRUE(outcome.err.ends_with(where)) << outcome.err;
    }
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(Usage, AMissingFileIsAnInputError) {
    expect_input_error("inspect absent.yaml", "absent.yaml");
    expect_input_error("calibrate " + fanuc_design + " -m absent.csv", "absent.csv");
    expect_input_error("calibrate " + fanuc_design + " -m absent.mat", "absent.mat");
}

}  // namespace
}  // namespace posewise::testing
