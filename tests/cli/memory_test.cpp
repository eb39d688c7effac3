#include "program.hpp"

namespace posewise::testing {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool is_sanitized = true;  // which reserves terabytes of addresses
#else
constexpr bool is_sanitized = false;
#endif

/// Eight threads, so that cross-validation in parallel needs the most memory.
class Memory : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        if (is_sanitized) GTEST_SKIP() << "memory cannot be limited under a sanitizer";
        run_well("simulate " + fanuc_design +
                 " --truth 7 --seed 3 --poses 400 --repeats 25 -o s.csv");
    }
    Outcome calibrate(int folds, int limit_kb) const {
        return run("calibrate " + fanuc_design + " -m s.csv --folds " + std::to_string(folds),
                   "ulimit -v " + std::to_string(limit_kb) +
                       " && OMP_NUM_THREADS=8 OMP_STACKSIZE=512k MALLOC_ARENA_MAX=1");
    }
};

TEST_F(Memory, ThatRunsOutInCrossValidationIsOneLineAndExitCodeOne) {
    constexpr int step_kb = 512;  // less than what cross-validation adds, wherever memory begins
    int limit_kb = 64 * step_kb;
    while (calibrate(0, limit_kb).code != 0) {
        limit_kb += step_kb;
        ASSERT_LT(limit_kb, 1 << 20);
    }
    int failures = 0;  // from just enough without cross-validation to enough with it
    for (Outcome outcome; outcome.code != 0; limit_kb += step_kb) {
        ASSERT_LT(limit_kb, 1 << 20);
        outcome = calibrate(100, limit_kb);
        const bool has_threads = outcome.err.find("Thread creation failed") == std::string::npos;
        if (outcome.code == 0 || !has_threads) continue;
        ++failures;
        EXPECT_EQ(outcome.code, 1);
        EXPECT_EQ(outcome.err.rfind("posewise: out of memory; ", 0), 0u) << outcome.err;
        EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    }
    EXPECT_GT(failures, 0);
}

}  // namespace
}  // namespace posewise::testing
