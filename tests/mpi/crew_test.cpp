// Crews that mpirun starts: trials of toy.cpp, and posewise itself under a launcher.

#include <csignal>

#include "program.hpp"

#ifndef POSEWISE_MPI_TOY  // built without MPI
#define POSEWISE_MPI_TOY ""
#define POSEWISE_MPIRUN ""
#endif

namespace posewise::testing {
namespace {

/// How often words stand in a text.
int count_of(const std::string& words, const std::string& text) {
    int count = 0;
    for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1)) {
        ++count;
    }
    return count;
}

class Crew : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        if (!std::filesystem::exists(POSEWISE_MPIRUN)) {
            GTEST_SKIP() << "no MPI: install Open MPI (Debian: libopenmpi-dev openmpi-bin)";
        }
    }

    /// Whatever the user may be, and however few the cores; ends in time. Leaks of parts that MPI
    /// has unloaded cannot be told from ours.
    Outcome run_by_mpi(int ranks, const std::string& program,
                       const std::string& time_limit = "100") const {
        return run_line(
            "ASAN_OPTIONS=detect_leaks=0 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
            "timeout " +
            time_limit + " '" POSEWISE_MPIRUN "' --oversubscribe -n " + std::to_string(ranks) +
            ' ' + program + " > .out 2> .err");
    }
    Outcome run_toy(int ranks, const std::string& arguments,
                    const std::string& time_limit = "100") const {
        return run_by_mpi(ranks, "'" POSEWISE_MPI_TOY "' " + arguments, time_limit);
    }

    /// One line of its own (others are mpirun's) and the exit code.
    static void expect_failure(const Outcome& outcome, int code, const std::string& words) {
        EXPECT_EQ(outcome.code, code) << words;
        EXPECT_EQ(outcome.out, "") << words;
        EXPECT_EQ(count_of("posewise: ", outcome.err), 1) << outcome.err;
        EXPECT_EQ(count_of(words, outcome.err), 1) << outcome.err;
    }
};

TEST_F(Crew, FindsTheSameWhateverTheNumberOfProcesses) {
    for (const int ranks : {1, 2, 4}) {
        const Outcome outcome = run_toy(ranks, "200 sleep 2");
        EXPECT_EQ(outcome.code, 0);
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(outcome.out, "2666600 of 200 by " + std::to_string(ranks) + '\n');
    }
}

TEST_F(Crew, RunsNoTrialsAndFewerThanProcesses) {
    EXPECT_EQ(run_toy(4, "0").out, "0 of 0 by 0\n");
    EXPECT_EQ(run_toy(4, "2 sleep 50").out, "2 of 2 by 2\n");
}

TEST_F(Crew, PassesOnWhatIsLarge) {
    EXPECT_EQ(run_toy(3, "60 large 30000").out.substr(0, 15), "53100000 of 60 ");
}

TEST_F(Crew, RunsOneListAfterAnother) {
    EXPECT_EQ(run_toy(3, "100 twice").out.substr(0, 15), "1124950 of 150 ");
}

TEST_F(Crew, FailsByAnExceptionInAnyProcess) {
    expect_failure(run_toy(3, "100 throw 0"), 3, "trial fails\\x0ain two lines");
    expect_failure(run_toy(3, "100 throw 77"), 3, "trial fails\\x0ain two lines");
    expect_failure(run_toy(3, "100 throw_memory 50"), 1, "out of memory");
}

TEST_F(Crew, FailsOutsideOfTrials) {
    expect_failure(run_toy(3, "100 throw_early"), 3, ": no such file");
    expect_failure(run_toy(3, "100 throw_first"), 3, "posewise: no such campaign");
    expect_failure(run_toy(3, "100 accept 5"), 3, "posewise: disk is full");
}

TEST_F(Crew, EndsWhenAProcessDies) {
    for (const std::string rank : {"0", "2"}) {
        const Outcome outcome = run_toy(3, "500 kill " + rank, "30");
        EXPECT_EQ(outcome.code, 128 + SIGKILL);
        EXPECT_EQ(outcome.out, "");
        EXPECT_EQ(count_of("process rank " + rank, outcome.err), 1) << outcome.err;
    }
}

TEST_F(Crew, StopsWithWhatIsFinished) {
    const Outcome stopped = run_toy(2, "100000 stop 100");
    EXPECT_EQ(stopped.code, 0) << stopped.err;
    EXPECT_GE(number_behind(stopped.out, "", 2), 100) << stopped.out;
    EXPECT_LT(number_behind(stopped.out, "", 2), 5000) << stopped.out;
    const Outcome late = run_toy(2, "100000 late 400");
    EXPECT_EQ(late.code, 0) << late.err;
    EXPECT_LT(number_behind(late.out, "", 2), 100) << late.out;
}

TEST_F(Crew, OfPosewiseSaysAllOnce) {
    const std::string posewise = "'" POSEWISE_PROGRAM "' ";
    EXPECT_EQ(count_of("Usage: ", run_by_mpi(3, posewise + "study --help").out), 1);
    expect_failure(run_by_mpi(3, posewise + "study none.yaml -m none.csv"), 1, "none.yaml");
}

TEST_F(Crew, OfPosewiseFindsTheSameBytes) {
    const std::string measured = "-m '" POSEWISE_SOURCE_DIR
                                 "/data/fanuc_r2000ic_165f_simulated/measurements.csv' --random 10";
    for (const std::string& kind : {std::string("--simulate --trials 20"), measured}) {
        const std::string study = "study " + fanuc_design + ' ' + kind + " --poses 8,12 --json";
        const std::string expected = run_well(study);
        for (const int ranks : {2, 4}) {
            const Outcome outcome = run_by_mpi(ranks, "'" POSEWISE_PROGRAM "' " + study);
            EXPECT_EQ(outcome.out, expected) << study << '\n' << outcome.err;
        }
    }
}

TEST_F(Crew, OfPosewiseGoesOnAfterItWasKilled) {
    const std::string study =
        "study " + fanuc_design + " --simulate --poses 8,12 --trials 300 --json";
    const std::string expected = run_well(study);
    const std::string kept = "'" POSEWISE_PROGRAM "' " + study + " --store kept.sqlite";
    for (const std::string second : {"1.5", "2", "2.5"})
        run_by_mpi(3, kept, "--signal=KILL " + second);
    // The ranks outlive mpirun for a moment, in which the store is theirs.
    Outcome last;
    for (int i = 0; i < 10 && last.code != 0; ++i) last = run_by_mpi(2, kept);
    EXPECT_EQ(last.out, expected) << last.err;
}

class Launched : public Program {};

TEST_F(Launched, IsRefusedWhereMpiIsMissing) {
    const std::string copy = "cp '" POSEWISE_PROGRAM "' . && ";
    for (const std::string variables :
         {"OMPI_COMM_WORLD_SIZE=3 OMPI_COMM_WORLD_RANK=", "PMI_SIZE=3 PMI_RANK=",
          "SLURM_STEP_NUM_TASKS=3 PMIX_RANK="}) {
        const Outcome first =
            run_line(copy + variables + "0 ./posewise study none.yaml > .out 2> .err");
        EXPECT_EQ(first.code, 1);
        EXPECT_EQ(count_of("built without MPI", first.err), 1) << first.err;
        const Outcome other =
            run_line(copy + variables + "1 ./posewise study none.yaml > .out 2> .err");
        EXPECT_EQ(other.code, 0);
        EXPECT_EQ(other.err, "");
    }
}

TEST_F(Launched, IsNoMatterForShardsAndOtherCommands) {
    for (const std::string command :
         {"study none.yaml -m none.csv --shard 1/3", "inspect none.yaml"}) {
        const Outcome outcome = run(command, "PMI_SIZE=3 PMI_RANK=1");
        EXPECT_NE(outcome.code, 0);
        EXPECT_EQ(count_of("MPI", outcome.err), 0) << outcome.err;
    }
    // Slurm counts the tasks of every step, whether or not they shall speak by MPI.
    EXPECT_EQ(count_of("MPI", run("study none.yaml -m none.csv", "SLURM_STEP_NUM_TASKS=3").err), 0);
}

TEST_F(Crew, IsRefusedUnderTheLauncherOfAnotherMpi) {
    const Outcome outcome = run("study none.yaml", "PMI_SIZE=3 PMI_RANK=0");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(count_of("but not by the MPI that posewise was built with", outcome.err), 1);
}

}  // namespace
}  // namespace posewise::testing
