#include "program.hpp"

/// The C library has other functions for CPUs with fused multiplication and addition than for those
/// without; plans must not depend on them.
namespace posewise::testing {
namespace {

using SamePlan = Program;

/// Takes them away where the library is glibc.
const std::string older_cpu = "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA";

TEST_F(SamePlan, IsChosenByTheFunctionsOfAnOlderCpu) {
    for (const std::string criterion : {"d", "e"}) {
        const std::string command =
            "select " + fanuc_design + " --random 100 -k 6 --starts 2 --criterion " + criterion;
        run_well(command + " --out plan.json");
        run_well(command + " --out older.json", older_cpu);
        EXPECT_EQ(text_of("plan.json"), text_of("older.json")) << criterion;
    }
}

TEST_F(SamePlan, IsRefinedInACellByTheFunctionsOfAnOlderCpu) {
    const std::string command = "plan '" + source_folder() +
                                "/designs/cell_demo/campaign.yaml' --poses 6 --pool 400 "
                                "--starts 2 --workspace-poses 50";
    run_well(command + " --out plan.json");
    run_well(command + " --out older.json", older_cpu);
    EXPECT_EQ(text_of("plan.json"), text_of("older.json"));
}

}  // namespace
}  // namespace posewise::testing
