#include "program.hpp"

/// `plan` that is asked for an accuracy or a duration in place of a number of poses.
namespace posewise::testing {
namespace {

const std::string quick = " --pool 150 --starts 1 --workspace-poses 20 -o p.json ";

class PlanTarget : public Program {
  protected:
    std::string plan(const std::string& arguments) const {
        return "plan " + fanuc_design + quick + arguments;
    }
    void expect_usage_error(const std::string& arguments, const std::string& words) const {
        const Outcome outcome = run(plan(arguments));
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
    }
};

TEST_F(PlanTarget, SaysHowManyPosesAndWhatTheErrorConsistsOf) {
    const std::string text = run_well(plan("--target-mm 1.2 --robust-to 1"));
    for (const char* const words :
         {"target:      1.2 mm RMS with 95 %, the worst 1 pose missing: ", "new poses",
          "; floor 0.78", "\nenough:      ", "missing:     without p",
          "parameters, by the model error", "Position error (RMS) by number of poses",
          "95 % below/mm", "minutes"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << '\n' << text;
    }
    run_well("verify p.json");
    const std::string timed = run_well(plan("--minutes 0.5"));
    EXPECT_NE(timed.find("\n\ntime:        "), std::string::npos) << timed;
}

TEST_F(PlanTarget, SaysWhatIsLeftAtBestAndWhatWouldLowerIt) {
    expect_input_error(plan("--target-mm 0.3"),
                       "--target-mm: 0.3 mm RMS with 95 %: unattainable: floor 0.78");
    expect_input_error(
        plan("--target-mm 0.3"),
        "the largest part is the model error, 0.1732 mm expected, of which the floor "
        "is the 95 % end; half the floor needs");
    expect_input_error(plan("--target-mm 0.79 --poses-at-most 9"),
                       "not reached: 9 new poses reach");
    expect_input_error(plan("--target-mm 0.9 --minutes 0.4"), "not reached in 0.4 min, in which");
    expect_input_error(plan("--minutes 0.01"), "are too short");
}

TEST_F(PlanTarget, RefusesWhatCannotBeMeant) {
    for (const char* const limit : {"0", "-1", "nan", "x", "''"}) {
        expect_usage_error("--target-mm " + std::string(limit), "--target-mm");
        expect_usage_error("--minutes " + std::string(limit), "--minutes");
    }
    for (const char* const assurance : {"0", "1", "95", "nan"}) {
        expect_usage_error("--target-mm 1 --assurance " + std::string(assurance), "--assurance");
    }
    expect_usage_error("--target-mm 1 --quantity mean", "--quantity");
    expect_usage_error("--target-mm 1 -k 12", "excludes");
    expect_usage_error("--poses-at-most 9 -k 12", "excludes");
    expect_usage_error("--minutes 1 -k 12", "excludes");
    expect_usage_error("--target-mm 1 --plan p.json", "excludes");
    expect_usage_error("--minutes 1 --assurance 0.9", "--target-mm");
    expect_usage_error("-k 12 --quantity max", "--target-mm");
    expect_usage_error("-k 12 --robust-to -1", "--robust-to");
    expect_usage_error("", "--poses, --target-mm or --minutes");
}

TEST_F(PlanTarget, IsVerifiedOnRobotsThatAreDrawn) {
    const std::string text = run_well(
        "plan " + fanuc_design +
        " -k 12 --pool 60 --starts 1 --workspace-poses 20 -o p.json --verify --verify-robots 100");
    for (const char* const words :
         {"closed form/mm  Monte Carlo/mm  sure to/mm", "\nexpected ", "\n95 % below ",
          "100 robots and 20 of expected sizes; not as sure as asked, 2 digits of 0.",
          "that was the most robots allowed (--verify-robots)"}) {
        EXPECT_NE(text.find(words), std::string::npos) << words << '\n' << text;
    }
    expect_usage_error("-k 12 --verify-robots 100", "--verify");
    expect_usage_error("-k 12 --verify --verify-digits 0", "--verify-digits");
    expect_input_error(plan("-k 12 --verify --repeats 1.5"), "repeats are 1.5; must be a whole");
}

TEST_F(PlanTarget, DwellIsTimeAtEachPose) {
    const std::string campaign =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    write_text("c.yaml", campaign + "cell: {dwell_s: 4}\n");
    const std::string text = run_well("plan c.yaml -k 8 --repeats 2" + quick);
    EXPECT_NE(text.find("min with 4 s for each sample"), std::string::npos) << text;
    // One reflector for three targets: 30 s by hand at 8 poses take longer than three runs.
    write_text("c.yaml", campaign +
                             "cell: {dwell_s: 4, target_change_s: 30, stations: 2, "
                             "station_change_s: 1200}\n");
    const std::string by_hand = run_well("plan c.yaml -k 8 --repeats 2" + quick);
    EXPECT_NE(by_hand.find("s for each sample, 3 runs, the reflector moved between them, all at "
                           "each of 2 stations\n"),
              std::string::npos)
        << by_hand;
    write_text("c.yaml", campaign + "cell: {stations: 0}\n");
    expect_input_error("plan c.yaml -k 8" + quick,
                       "stations is 0; must be a whole number from 1 to 100");
    write_text("c.yaml", campaign + "cell: {dwell_s: -4}\n");
    expect_input_error("plan c.yaml -k 8" + quick, "dwell_s is -4; must be from 0 to 86400");
}

}  // namespace
}  // namespace posewise::testing
