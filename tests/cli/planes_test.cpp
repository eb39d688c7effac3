#include "program.hpp"

/// Planes that are known in part, through every command.
namespace posewise::testing {
namespace {

const std::string planes = "name: arm\nrobot:\n  errors: geometric\n" + six_joints +
                           R"(base: {position_mm: [0, 0, 0], rpy_deg: [0, 0, 0], known: true}
sensor:
  kind: planes
  sigma_mm: 0.01
  planes:
    - {normal: [0, 0, 1], offset_mm: 300, known: [normal]}
    - {normal: [1, 0, 0], offset_mm: 900, known: [offset]}
    - {normal: [0.1, 1, 0], offset_mm: 700}
  targets: {position_mm: [[0, 0, 150]]}
)";

class Planes : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("c.yaml", planes);
        std::string open = planes;
        for (const std::string part : {", known: [normal]", ", known: [offset]"}) {
            open.erase(open.find(part), part.size());
        }
        write_text("open.yaml", open);
        run_well("simulate c.yaml --poses 40 -o m.csv");
    }
};

TEST_F(Planes, AreCalibratedWithWhatIsKnownOfThem) {
    const std::string truth = run_well("simulate c.yaml --poses 40 -o m.csv");
    const std::string found = run_well("calibrate c.yaml -m m.csv -o e.json");
    const std::string with_all = run_well("calibrate open.yaml -m m.csv --folds 0");
    for (const char* const name : {"plane1.offset", "plane2.tilt1", "plane2.tilt2"}) {
        const double sigma = number_behind(found, name, 2);
        EXPECT_NEAR(number_behind(found, name), number_behind(truth, name), 4 * sigma) << name;
        EXPECT_LT(sigma, number_behind(with_all, name, 2)) << name;
    }
    for (const char* const known : {"plane1.tilt1", "plane2.offset"}) {
        EXPECT_EQ(found.find(known), std::string::npos) << known;
        EXPECT_NE(with_all.find(known), std::string::npos) << known;
    }
    EXPECT_NEAR(number_behind(found, "variance factor"), 1, 0.6);
}

TEST_F(Planes, AreTakenByEveryCommand) {
    run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    EXPECT_NE(run_well("inspect c.yaml -m m.csv").find("3 planes (known in part)"),
              std::string::npos);
    run_well("indices c.yaml -m m.csv");
    run_well("select c.yaml -m m.csv -k 16 --starts 2 --proof 0.1 -o s.json");
    EXPECT_EQ(run("verify s.json").code, 0);
    run_well("plan c.yaml -k 9 --pool 40 --workspace-poses 30 --starts 1 --from e.json -o p.json");
    EXPECT_EQ(run("verify p.json").code, 0);
    run_well("study c.yaml -m m.csv -k 20 --splits 2 --random 3");
    run_well("export c.yaml e.json --dh dh.yaml");
    run_well("simulate c.yaml --poses 30 --seed 5 -o next.csv");
    const std::string held = run_well("calibrate c.yaml -m next.csv --from e.json --only targets");
    EXPECT_NE(held.find("plane1.offset"), std::string::npos);
    EXPECT_EQ(held.find("plane1.tilt1"), std::string::npos);
    run_well("calibrate c.yaml -m next.csv --from e.json --as-prior --folds 0");
    run_well("calibrate c.yaml -m m.csv --validate next.csv --refit targets --folds 0");
}

TEST_F(Planes, AreTakenFromAnEstimateThatKnewAsMuch) {
    run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    run_well("calibrate open.yaml -m m.csv --folds 0 -o open.json");
    expect_input_error("inspect open.yaml --from e.json",
                       "e.json: sensor: has no plane1.tilt1_rad; what is known of base and sensor");
    expect_input_error("inspect c.yaml --from open.json",
                       "has 30 parameters in 30 rows, the campaign 27; what is known of base");
    run_well("calibrate open.yaml -m m.csv --from e.json --moved targets --folds 0");
}

}  // namespace
}  // namespace posewise::testing
