#include <nlohmann/json.hpp>

#include "program.hpp"

/// Measurements left out by hand, joints that never move, outliers of poses, and validations with
/// another set-up.
namespace posewise::testing {
namespace {

using Json = nlohmann::json;

const std::string arm = "name: arm\nrobot:\n  errors: geometric\n" + six_joints;
const std::string points =
    R"(base: {position_mm: [1500, 200, -300], rpy_deg: [0, 0, 90]}
sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[90, 0, 60], [90, 80, -30], [150, -70, 20]]}}
)";

class Exclude : public Program {
  protected:
    void measure(const std::string& sensor) const {
        write_text("c.yaml", arm + sensor);
        run_well("simulate c.yaml --poses 30 --repeats 3 -o s.csv");
    }
    /// s.csv without, or with other, rows; `change` takes the row's cells and its number.
    template <class Change>
    void rewrite(const std::string& name, const Change& change) const {
        std::istringstream lines(text_of("s.csv"));
        std::string text;
        Index number = -1;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            std::vector<std::string> cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            if (number >= 0 && !change(cells, number)) continue;
            ++number;
            for (std::size_t k = 0; k < cells.size(); ++k) text += (k > 0 ? "," : "") + cells[k];
            text += '\n';
        }
        write_text(name, text);
    }
    using Index = long;
};

TEST_F(Exclude, LeavesOutConfigurationsAndSamples) {
    measure(points);
    const std::string bad = "4";
    rewrite("bad.csv", [&](std::vector<std::string>& cells, Index) {
        if (cells[0] == bad) cells.back() = "900";
        return true;
    });
    rewrite("rest.csv", [&](std::vector<std::string>& cells, Index) { return cells[0] != bad; });
    const std::string rest = run_well("calibrate c.yaml -m rest.csv --folds 0");
    const std::string text =
        run_well("calibrate c.yaml -m bad.csv --exclude " + bad + " --folds 0 --out e.json");
    EXPECT_NE(text.find("arm: 29 configurations, 87 samples"), std::string::npos) << text;
    EXPECT_NE(text.find("\nexcluded: 4\n"), std::string::npos) << text;
    EXPECT_EQ(number_behind(text, "distance RMS", 1), number_behind(rest, "distance RMS", 1));
    EXPECT_EQ(Json::parse(text_of("e.json")).at("excluded"), Json::array({"4"}));
    run_well("calibrate c.yaml -m s.csv --exclude 4:2,7 --folds 0 --out e.json");
    const Json estimate = Json::parse(text_of("e.json"));
    EXPECT_EQ(estimate.at("excluded"), Json::array({"4:2", "7"}));
    EXPECT_EQ(estimate.at("measured").at("samples"), 86);
    const std::string indices = run_well("indices c.yaml -m s.csv --exclude 4 7");
    EXPECT_EQ(indices.rfind("28 configurations", 0), 0U) << indices;
    run_well("study c.yaml -m bad.csv --exclude 4 --splits 0 -k 20 --random 2");
}

/// By the number in the file's column, which begins at 0 in what `simulate` writes.
TEST_F(Exclude, NamesASampleAsTheFileDoes) {
    measure(points);
    const auto spoil = [&](const std::string& sample) {
        rewrite("bad.csv", [&](std::vector<std::string>& cells, Index) {
            if (cells[0] == "4" && cells[1] == sample) cells.back() = "900";
            return true;
        });
        return number_behind(
            run_well("calibrate c.yaml -m bad.csv --folds 0 --exclude 4:" + sample), "distance RMS",
            1);
    };
    for (const std::string sample : {"0", "1", "2"}) EXPECT_LT(spoil(sample), 0.5) << sample;
    std::istringstream lines(text_of("s.csv"));
    std::string unnumbered;
    for (std::string line; std::getline(lines, line);) {
        if (line[0] == '#') continue;
        const std::size_t sample = line.find(',');
        unnumbered += line.substr(0, sample) + line.substr(line.find(',', sample + 1)) + '\n';
    }
    write_text("unnumbered.csv", unnumbered);
    run_well("calibrate c.yaml -m unnumbered.csv --folds 0 --exclude 4:3");
    expect_input_error("calibrate c.yaml -m unnumbered.csv --folds 0 --exclude 4:0",
                       "configuration '4' has 3 samples, 4:1 to 4:3");
}

TEST_F(Exclude, IsOfWhatIsThere) {
    measure(points);
    const std::string calibrate = "calibrate c.yaml -m s.csv --exclude ";
    expect_input_error(calibrate + "99",
                       "s.csv: excluded configuration '99' is not among the measured ones; must be "
                       "an id, one and the number of a sample like ");
    expect_input_error(calibrate + "4:3",
                       "s.csv: excluded sample '4:3' is not among the measured "
                       "ones; configuration '4' has 3 samples, 4:0 to 4:2");
    expect_input_error(calibrate + "4:x", "'4:x' is not among the measured ones");
    expect_input_error(calibrate + "4:2,4", "'4' is excluded twice; keep one");
    std::string all = "0";
    for (int k = 1; k < 30; ++k) all += ',' + std::to_string(k);
    expect_input_error("indices c.yaml -m s.csv --exclude " + all, "nothing is left");
    EXPECT_EQ(run("calibrate c.yaml -m s.csv --exclude 4,,5").code, 2);
    expect_input_error(calibrate + "6-4", "'6-4': '6' stands after '4' in the measurements' order");
    expect_input_error(calibrate + "5,4-6", "'4-6' is excluded twice; keep one");
}

TEST_F(Exclude, TakesARangeInTheOrderOfTheFile) {
    measure(points);
    const std::string calibrate = "calibrate c.yaml -m s.csv --folds 0 --json --exclude ";
    const Json by_range = Json::parse(run_well(calibrate + "4-6,9"));
    const Json by_ids = Json::parse(run_well(calibrate + "4,5,6,9"));
    EXPECT_EQ(by_range["robot"], by_ids["robot"]);
    EXPECT_EQ(by_range["measured"]["configurations"], by_ids["measured"]["configurations"]);
}

TEST_F(Exclude, WinsOverThePlan) {
    measure(points);
    run_well("select c.yaml -m s.csv -k 20 --proof 0 --out p.json");
    const Json plan = Json::parse(text_of("p.json"));
    const std::string first = plan.at("poses").at(0).at("id").get<std::string>();
    const std::string text =
        run_well("calibrate c.yaml -m s.csv --plan p.json --folds 0 --exclude " + first);
    EXPECT_NE(text.find("arm: 19 configurations"), std::string::npos) << text;
}

TEST_F(Exclude, JointsThatNeverMoveAreNamed) {
    std::string still = arm + points;
    for (const std::string limits :
         {"q1: {limits_deg: [-170, 170]}", "q6: {limits_deg: [-170, 170]}"}) {
        still.replace(still.find(limits), limits.size(),
                      limits.substr(0, 4) + "{limits_deg: [10, 10.00001]}");
    }
    measure(points);
    write_text("still.yaml", still);
    run_well("simulate still.yaml --poses 60 -o still.csv");
    const Outcome outcome = run("calibrate c.yaml -m still.csv --prior --folds 0");
    EXPECT_NE(outcome.err.find("posewise: warning: still.csv: q1 and q6 are the same in all "
                               "configurations: these say little about their errors; are all "
                               "columns right?\n"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(run("calibrate c.yaml -m s.csv --folds 0").err, "");
}

TEST_F(Exclude, OutliersOfPosesAreLeftOutOfBothResiduals) {
    measure(measured_poses);
    rewrite("bad.csv", [](std::vector<std::string>& cells, Index) {
        if (cells[0] == "4") cells.back() = std::to_string(std::stod(cells.back()) + 0.1);
        return true;
    });
    const std::string text = run_well("calibrate c.yaml -m bad.csv --loss cauchy --out e.json");
    EXPECT_NE(text.find(": 1 outlier\n"), std::string::npos) << text;
    EXPECT_NE(text.find(" (RMS of distances and of orientations)\n"), std::string::npos) << text;
    const double angle = number_behind(text, "without them: means", 3);
    EXPECT_GT(angle, 0.05);
    EXPECT_LT(angle, 0.5);
    const Json estimate = Json::parse(text_of("e.json"));
    const Json& others = estimate.at("accuracy").at("without_outliers");
    EXPECT_NEAR(others.at("fit_means_rms_mrad").get<double>(), angle, 1e-3);
    EXPECT_LT(others.at("held_out_means_rms_mrad").get<double>(), 0.6);
    EXPECT_LT(others.at("held_out_means_rms_mm").get<double>(), 0.5);
    EXPECT_LT(estimate.at("outliers").at(0).at("distance_mm").get<double>(), 1)
        << "its position is right";
}

TEST_F(Exclude, AValidationWithAnotherSetUpIsNamed) {
    measure(points);
    std::string moved = arm + points;
    moved.replace(moved.find("1500, 200, -300"), 15, "1700, 200, -300");
    write_text("moved.yaml", moved);
    run_well("simulate moved.yaml --poses 20 -o v.csv");
    const Outcome outcome = run("calibrate c.yaml -m s.csv --folds 0 --validate v.csv --json");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find("the validation was measured with another set-up, base 200 mm from "
                               "where the calibration has it: --refit base identifies it anew\n"),
              std::string::npos)
        << outcome.err;
    const Json accuracy = Json::parse(outcome.out).at("accuracy");
    EXPECT_NEAR(accuracy.at("moved_before_validation").at("base_mm").get<double>(), 200, 1);
    const std::string text = run("calibrate c.yaml -m s.csv --folds 0 --validate v.csv").out;
    EXPECT_NE(text.find(": measured with another set-up\n"), std::string::npos) << text;
    run_well("calibrate c.yaml -m s.csv --folds 0 --validate v.csv --refit base,targets");
    run_well("simulate c.yaml --seed 9 --poses 20 -o same.csv");
    run_well("calibrate c.yaml -m s.csv --folds 0 --validate same.csv");
}

}  // namespace
}  // namespace posewise::testing
