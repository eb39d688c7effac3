#include <array>
#include <cmath>

#include "program.hpp"

/// What is said of planes, orientations and terms that look wrong, on an arm seen by other sensors
/// than of points.
namespace posewise::testing {
namespace {

const std::string arm = "name: arm\nrobot:\n  errors: geometric\n" + six_joints;

const std::string planes = arm + R"(base: {position_mm: [0, 0, 0], rpy_deg: [0, 0, 0], known: true}
sensor:
  kind: planes
  sigma_mm: 0.01
  planes: [{normal: [0, 0, 1], offset_mm: 300}, {normal: [1, 0, 0], offset_mm: 900}, {normal: [0.1, 1, 0], offset_mm: 700}]
  known_planes: false
  targets: {position_mm: [[0, 0, 150]]}
)";

const std::string poses = arm + measured_poses;

class Suspicions : public Program {
  protected:
    /// Writes the text with one part replaced by another.
    void write_with(const std::string& name, std::string text, const std::string& part,
                    const std::string& by) const {
        ASSERT_NE(text.find(part), std::string::npos) << part;
        write_text(name, text.replace(text.find(part), part.size(), by));
    }

    /// s.csv with the rotation vectors as quaternions, those of `columns` (0: real part) with
    /// signs.
    void write_quaternions(const std::string& name, const std::array<std::size_t, 4>& columns,
                           double sign_of_vector, double times = 1) const {
        std::istringstream lines(text_of("s.csv"));
        std::string text;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            std::vector<std::string> cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            std::vector<std::string> last{"qw", "qx", "qy", "qz"};
            if (cells[0] != "config") {
                std::array<double, 4> q{};
                for (std::size_t k = 1; k < 4; ++k) q[k] = std::stod(cells[cells.size() - 4 + k]);
                const double angle = std::hypot(q[1], q[2], q[3]);
                for (std::size_t k = 1; k < 4; ++k)
                    q[k] *= sign_of_vector * std::sin(times * angle / 2) / angle;
                q[0] = std::cos(times * angle / 2);
                for (std::size_t k = 0; k < 4; ++k) last[k] = std::to_string(q[columns[k]]);
            }
            cells.resize(cells.size() - 3);
            for (const std::string& cell : cells) text += cell + ',';
            text += last[0] + ',' + last[1] + ',' + last[2] + ',' + last[3] + '\n';
        }
        write_text(name, text);
    }

    /// The warnings of a calibration.
    std::string warnings_of(const std::string& arguments) const {
        const Outcome outcome = run("calibrate " + arguments + " --folds 0 --force");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.err;
    }
};

TEST_F(Suspicions, AReversedPlaneIsNamed) {
    write_text("c.yaml", planes);
    run_well("simulate c.yaml --poses 40 -o s.csv");
    EXPECT_EQ(warnings_of("c.yaml -m s.csv"), "");
    const std::string second =
        "s.csv: plane 2 looks reversed: stated with normal [-1.000, 0.000, "
        "0.000] and offset 900.0 mm, measured at about normal [1.000, 0.000, "
        "0.000] and offset 900.";
    write_with("r.yaml", planes, "[1, 0, 0]", "[-1, 0, 0]");
    const std::string warnings = warnings_of("r.yaml -m s.csv");
    EXPECT_NE(warnings.find("posewise: warning: " + second), std::string::npos) << warnings;
    EXPECT_EQ(warnings.find("plane 1"), std::string::npos) << warnings;
}

TEST_F(Suspicions, ATurnedPlaneIsNotCalledReversed) {
    write_text("c.yaml", planes);
    run_well("simulate c.yaml --poses 40 -o s.csv");
    write_with("t.yaml", planes, "[1, 0, 0]", "[0, 0, 1]");
    const std::string said = run("calibrate t.yaml -m s.csv --folds 0").err;
    EXPECT_NE(said.find("plane 2 looks turned by "), std::string::npos) << said;
    EXPECT_EQ(said.find("reversed"), std::string::npos) << said;
}

TEST_F(Suspicions, APlaneThatRunsAwayIsNoCalibration) {
    write_text("c.yaml", planes);
    run_well("simulate c.yaml --poses 40 -o s.csv");
    write_with("r.yaml", planes, "[0.1, 1, 0]", "[0.1, 0.3, 1]");
    const Outcome outcome = run("calibrate r.yaml -m s.csv --folds 0");
    EXPECT_EQ(outcome.code, 3) << outcome.out;
    EXPECT_NE(outcome.err.find("plane 3 is turned by 7"), std::string::npos) << outcome.err;
}

TEST_F(Suspicions, AKnownPlaneThatIsReversedIsNamedWhereTheMeasurementsAreRefused) {
    write_text("c.yaml", planes);
    run_well("simulate c.yaml --poses 40 -o s.csv");
    std::string known = planes;
    known.replace(known.find("known_planes: false"), 19, "known_planes: true");
    write_with("r.yaml", known, "[1, 0, 0]", "[-1, 0, 0]");
    expect_input_error("select r.yaml -m s.csv -k 30", "; plane 2 looks reversed: stated with ");
    write_with("o.yaml", known, "offset_mm: 300", "offset_mm: -300");
    expect_input_error("select o.yaml -m s.csv -k 30",
                       "; plane 1 looks reversed: stated with normal [0.000, 0.000, 1.000] and "
                       "offset -300.0 mm, measured at about normal [0.000, 0.000, 1.000] and "
                       "offset 30");
    write_text("k.yaml", known);
    EXPECT_EQ(warnings_of("k.yaml -m s.csv"), "");
}

TEST_F(Suspicions, AJointThatTurnsTheOtherWayIsNoReversedPlane) {
    std::string known = planes;
    known.replace(known.find("known_planes: false"), 19, "known_planes: true");
    write_text("c.yaml", known);
    run_well("simulate c.yaml --poses 40 -o s.csv");
    write_with("r.yaml", known, "Rz q1", "Rz -q1");
    expect_input_error("select r.yaml -m s.csv -k 30", "they fit clearly better with q1 reversed");
    EXPECT_EQ(run("select r.yaml -m s.csv -k 30").err.find("looks reversed"), std::string::npos);
}

TEST_F(Suspicions, PosesInAnotherUnitAreAskedFor) {
    write_text("c.yaml", poses);
    run_well("simulate c.yaml --poses 20 -o s.csv");
    std::string text = text_of("s.csv");
    const std::string columns = "x_mm,y_mm,z_mm";
    ASSERT_NE(text.find(columns), std::string::npos) << text;
    text.replace(text.find(columns), columns.size(), "x_m,y_m,z_m");
    write_text("m.csv", text);
    const std::string warnings = warnings_of("c.yaml -m m.csv");
    EXPECT_NE(warnings.find("they fit clearly better with poses in mm where the file says m ("),
              std::string::npos)
        << warnings;
}

TEST_F(Suspicions, QuaternionsInAnotherSenseAreNamed) {
    write_text("c.yaml", poses);
    run_well("simulate c.yaml --poses 20 -o s.csv");
    write_quaternions("right.csv", {0, 1, 2, 3}, 1);
    EXPECT_EQ(warnings_of("c.yaml -m right.csv"), "");
    write_quaternions("conjugate.csv", {0, 1, 2, 3}, -1);
    const std::string conjugate = warnings_of("c.yaml -m conjugate.csv");
    EXPECT_NE(conjugate.find("with qw, qx, qy, qz conjugate ("), std::string::npos) << conjugate;
    EXPECT_NE(conjugate.find("the nominal robot misses the poses by"), std::string::npos);
    write_quaternions("last.csv", {1, 2, 3, 0}, 1);
    const std::string last = warnings_of("c.yaml -m last.csv");
    EXPECT_NE(last.find("name the columns qx, qy, qz, qw"), std::string::npos) << last;
    EXPECT_EQ(last.find("conjugate"), std::string::npos) << last;
}

TEST_F(Suspicions, OrientationsThatFitInNoSenseAreAskedFor) {
    write_text("c.yaml", poses);
    run_well("simulate c.yaml --poses 20 -o s.csv");
    // Vectors exchanged in turn and one reversed are orientations in other axes.
    write_quaternions("turned.csv", {2, 0, 1, 3}, 1);
    const std::string turned = warnings_of("c.yaml -m turned.csv");
    EXPECT_NE(turned.find("write -y, -z, x into the columns x, y, z"), std::string::npos) << turned;
    // Turned twice as far they are in none.
    write_quaternions("mixed.csv", {0, 1, 2, 3}, 1, 2);
    const std::string mixed = warnings_of("c.yaml -m mixed.csv");
    EXPECT_NE(mixed.find("deg (RMS); in no other sense of their columns that was tried"),
              std::string::npos)
        << mixed;
}

TEST_F(Suspicions, PosesAndToolsAreCalledSo) {
    write_text("c.yaml", poses);
    const std::string truth = run_well("simulate c.yaml --poses 30 --repeats 3 -o s.csv");
    const std::string title = "arameters (errors of the robot, base, tool in the flange frame)\n";
    EXPECT_NE(truth.find("\nTrue p" + title), std::string::npos) << truth;
    const std::string found = run_well("calibrate c.yaml -m s.csv --folds 0");
    EXPECT_NE(found.find("\nP" + title), std::string::npos) << found;
    for (const std::string name : {"base.x", "tool.x", "tool.y", "tool.z", "Tx1"}) {
        EXPECT_NEAR(number_behind(found, name), number_behind(truth, name), 0.2) << name;
    }
    run_well("simulate c.yaml --poses 2 -o few.csv");
    expect_input_error("calibrate c.yaml -m few.csv",
                       "these 2 poses do not determine base and tool");
}

TEST_F(Suspicions, TermsWithoutAClearGapAreNamed) {
    std::string text = poses;
    text.insert(text.find("base:"), "  harmonics: {orders: [1, 2, 3, 4, 5], joints: [q4]}\n");
    write_text("wide.yaml", text);
    run_well("inspect wide.yaml");
    write_with("narrow.yaml", text, "q4: {limits_deg: [-150, 150]}", "q4: {limits_deg: [-10, 10]}");
    const Outcome outcome = run("inspect narrow.yaml");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err.find("posewise: warning: narrow.yaml: no gap between what is"), 0U)
        << outcome.err;
    EXPECT_NE(outcome.err.find("the weakest direction kept is of q4."), std::string::npos)
        << outcome.err;
    write_text("prior.yaml", text_of("narrow.yaml") + "prior: true\n");
    run_well("inspect prior.yaml");
}

}  // namespace
}  // namespace posewise::testing
