#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "../../src/io/format/atomic_file.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/cells.hpp"
#include "support/sensors.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using nlohmann::json;
using testing::input_error_of;
using testing::TemporaryFolder;

const std::string begin_mark = R"(<script type="application/json" id="posewise">)";

/// The text of the page's document.
std::string embedded(const std::string& page) {
    const auto begin = page.find(begin_mark) + begin_mark.size();
    return page.substr(begin, page.find("</script>", begin) - begin);
}

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

PagePart part_of(const std::string& title) {
    PagePart part;
    part.title = title;
    part.made_at = "2026-11-23T13:14:29Z";
    part.document = R"({"kind": "posewise study", "campaign": ")" + title + R"("})";
    return part;
}

TEST(ToPage, PutsTheDocumentWhereItBelongsAndNothingElse) {
    const std::string empty = to_page({});
    ASSERT_EQ(count_of(empty, begin_mark), 1U);
    EXPECT_EQ(json::parse(embedded(empty))["parts"], json::array());
    const std::string page = to_page({part_of("a"), part_of("b")});
    const std::string before = page.substr(0, page.find(begin_mark));
    EXPECT_EQ(before, empty.substr(0, empty.find(begin_mark)));
    const std::string behind = page.substr(page.find(embedded(page)) + embedded(page).size());
    EXPECT_TRUE(empty.ends_with(behind));
    const json document = json::parse(embedded(page));
    EXPECT_EQ(document["kind"], "posewise page");
    ASSERT_EQ(document["parts"].size(), 2U);
    EXPECT_EQ(document["parts"][1]["document"]["campaign"], "b");
    EXPECT_TRUE(document["parts"][1]["command"].is_null());
    EXPECT_FALSE(document["parts"][1].contains("scene"));
    EXPECT_EQ(document, json::parse(to_json(std::vector<PagePart>{part_of("a"), part_of("b")})));
}

TEST(ToPage, LeavesHostileNamesText) {
    for (const std::string name :
         {"</script><script>alert(1)</script>", "<!-- <script>", "a & b &lt;", "]]>",
          "line\u2028and\u2029line", "$& $1 {{x}} \\\\u003c"}) {
        const std::string page = to_page({part_of(name)});
        const std::string text = embedded(page);
        EXPECT_EQ(text.find_first_of("<>&"), std::string::npos) << name;
        EXPECT_EQ(text.find("\u2028"), std::string::npos);
        EXPECT_EQ(text.find("\u2029"), std::string::npos);
        EXPECT_EQ(count_of(page, "</script"), count_of(to_page({}), "</script"));
        const json part = json::parse(text)["parts"][0];
        EXPECT_EQ(part["title"], name);
        EXPECT_EQ(part["document"], json::parse(part_of(name).document));
    }
}

TEST(ToPage, RefusesWhatIsNoDocument) {
    PagePart part = part_of("plan.json");
    part.document = "{";
    EXPECT_EQ(input_error_of([&] { to_page({part}); }),
              "plan.json: is not JSON; must be a document of posewise");
    part = part_of("a");
    part.title = "\xff";
    EXPECT_NE(input_error_of([&] { to_page({part}); }).find("is not UTF-8"), std::string::npos);
    part.title = "a";
    part.command = "posewise plan \xff.yaml";  // as the user typed it
    EXPECT_EQ(json::parse(embedded(to_page({part})))["parts"][0]["command"],
              "posewise plan \uFFFD.yaml");
}

TEST(ToPage, HasTheSceneAndWhatIsLeftOfReadings) {
    Campaign campaign = testing::cell_campaign();
    const Measurements measured = simulate(campaign, {.pose_count = 12, .repeats = 2}).measurements;
    campaign.cell = testing::demo_cell();
    const Calibration found = calibrate(campaign, measured);
    PagePart part = part_of("cell");
    part.scene = make_scene(found.campaign, found.estimate.parameters);
    part.configurations = {measured.ids, measured.configurations};
    part.residuals = page_residuals(found.campaign, measured, list_residuals(found, measured));
    part.error_map =
        ErrorMap{{measured.configurations.row(0), {1, 2, 3}, 1e-4, Vector3d(1e-3, 0, 0)}};
    const json shown = json::parse(embedded(to_page({part})))["parts"][0];

    const json& scene = shown["scene"];
    const auto joints = shown["configurations"]["joints"][0].get<std::vector<double>>();
    const Isometry3d flange = world_from_flange(found.campaign, found.estimate.parameters,
                                                Eigen::Map<const VectorXd>(joints.data(), 6));
    for (std::size_t k = 0; k < 16; ++k) {
        const auto number = static_cast<Index>(k);
        EXPECT_NEAR(scene["flange_of_first_pose"][k].get<double>(),
                    flange.matrix()(number / 4, number % 4), 1e-12);
    }
    EXPECT_EQ(scene["joints"][1]["name"], campaign.robot.joint(1).name);
    EXPECT_EQ(scene["capsules"][0]["kind"], "link");
    EXPECT_EQ(scene["boxes"][0]["kind"], "keep_out");
    EXPECT_EQ(scene["instrument"]["kind"], "tracker");
    ASSERT_EQ(shown["configurations"]["joints"].size(), 12U);
    EXPECT_EQ(shown["configurations"]["id"][3], measured.ids[3]);
    EXPECT_NEAR(shown["configurations"]["joints"][3][2], measured.configurations(3, 2), 5.1e-7);

    const json& readings = shown["residuals"]["readings"];
    EXPECT_EQ(shown["residuals"]["unit"], json({"mm", "mm", "mm"}));
    EXPECT_EQ(readings["configuration"][6], 1);
    EXPECT_EQ(readings["sample"][4], "2");
    EXPECT_EQ(shown["residuals"]["targets"][readings["target"][4].get<std::size_t>()], "target2");
    double squares = 0;
    for (const json& axis : readings["residual"]) {
        ASSERT_EQ(axis.size(), 72U);
        for (const json& one : axis) squares += std::pow(1e-9 * one.get<double>(), 2);
    }
    EXPECT_NEAR(std::sqrt(squares / 72), found.estimate.fit.distance_rms, 1e-9);
    EXPECT_EQ(shown["error_map"]["predicted_mm"][0], 0.1);
    EXPECT_EQ(shown["error_map"]["displacement_mm"][0], json({1.0, 0.0, 0.0}));

    // Torques that were measured with the joints are no joints.
    part.error_map->front().configuration.conservativeResize(8);
    part.residuals->readings[0].held_out.reset();
    const json again = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0];
    EXPECT_EQ(again["error_map"], shown["error_map"]);
    EXPECT_TRUE(again["residuals"]["readings"]["held_out"][2][0].is_null());
    EXPECT_TRUE(again["residuals"]["readings"]["held_out"][2][1].is_number_integer());
    EXPECT_EQ(again["residuals"]["readings"]["nominal"], readings["nominal"]);
    for (ReadingResidual& reading : part.residuals->readings) reading.held_out.reset();
    const json without = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0];
    EXPECT_FALSE(without["residuals"]["readings"].contains("held_out"));

    // Poses that it was judged at: the same residuals here, since they are the same poses.
    part.residuals->judged.emplace_back(
        "validation",
        page_residuals(found.campaign, measured,
                       list_residuals(found.campaign, found.estimate.parameters, measured)));
    const json judged = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0];
    const json& others = judged["residuals"]["validation"];
    EXPECT_EQ(others["axes"], shown["residuals"]["axes"]);
    EXPECT_EQ(others["readings"]["residual"], readings["residual"]);
    EXPECT_EQ(others["readings"]["target"], readings["target"]);
    EXPECT_EQ(others["readings"].size(), 2U);
}

TEST(ToPage, HasThePlacesInTheImageOfEachCamera) {
    CameraSetup setup = testing::three_cameras();
    setup.others[1].image.reset();
    const Campaign campaign =
        testing::before_camera(testing::tracked_campaign(testing::fanuc()), setup);
    const Measurements measured = simulate(campaign, {.pose_count = 20, .repeats = 1}).measurements;
    const std::vector<ReadingResidual> listed =
        list_residuals(campaign, campaign.nominal, measured);
    PagePart part = part_of("cameras");
    part.residuals = page_residuals(testing::tracked_campaign(testing::fanuc()), {}, {});
    EXPECT_TRUE(part.residuals->images.empty());
    part.residuals->judged.emplace_back("validation", page_residuals(campaign, measured, listed));
    const json all = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0]["residuals"];
    EXPECT_FALSE(all.contains("images"));
    EXPECT_FALSE(all["readings"].contains("place"));

    const json& shown = all["validation"];
    ASSERT_EQ(shown["images"].size(), 3U);
    EXPECT_EQ(shown["images"][1]["size_px"], json({1280.0, 960.0}));
    EXPECT_EQ(shown["images"][1]["columns"], 8);
    EXPECT_EQ(shown["images"][1]["counts"].size(), 48U);
    EXPECT_EQ(shown["images"][1]["name"], "camera 2");
    EXPECT_EQ(shown["images"][2].size(), 2U);  // rms_px and name
    const json& readings = shown["readings"];
    ASSERT_EQ(readings["camera"].size(), listed.size());
    const Index corners = std::ssize(setup.corners);
    std::array<double, 3> squares{};
    std::array<double, 3> counts{};
    for (std::size_t k = 0; k < listed.size(); ++k) {
        const ReadingResidual& one = listed[k];
        const auto camera = static_cast<std::size_t>(one.target / corners);
        EXPECT_EQ(readings["camera"][k], camera);
        for (const Index axis : {0, 1}) {
            EXPECT_NEAR(readings["place"][static_cast<std::size_t>(axis)][k].get<double>(),
                        1e3 * measured.observation(one.sample, one.target)(axis), 0.0051);
        }
        squares[camera] += one.calibrated.squaredNorm();
        ++counts[camera];
    }
    for (std::size_t camera = 0; camera < 3; ++camera) {
        ASSERT_GT(counts[camera], 0);
        EXPECT_NEAR(shown["images"][camera]["rms_px"].get<double>(),
                    1e3 * std::sqrt(squares[camera] / counts[camera]), 1e-9);
    }
}

TEST(ToPage, HasCamerasBoardAndWhereTheyAreAtOtherPoses) {
    const Campaign campaign = testing::before_camera(testing::tracked_campaign(testing::fanuc()),
                                                     testing::camera_on_flange());
    const Measurements measured = simulate(campaign, {.pose_count = 8, .repeats = 1}).measurements;
    const auto residuals = [&] {
        return page_residuals(campaign, measured,
                              list_residuals(campaign, campaign.nominal, measured));
    };
    PagePart part = part_of("camera");
    part.scene = make_scene(campaign, campaign.nominal);
    part.residuals = residuals();
    for (ReadingResidual& one : part.residuals->readings) {
        one.nominal = one.standardised = one.calibrated;
    }
    part.residuals->judged = {{"validation", residuals()}, {"left_out", residuals()}};
    part.residuals->judged[0].second.has_own_set_up = true;
    const json shown = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0];

    const json& views = shown["scene"]["views"];
    EXPECT_EQ(views["on_flange"], "camera");
    for (std::size_t k = 0; k < 16; ++k) {
        const auto number = static_cast<Index>(k);
        EXPECT_EQ(views["flange_from_it"][k].get<double>(),
                  part.scene->views->flange_from_it.matrix()(number / 4, number % 4));
    }
    EXPECT_EQ(views["cameras"][0]["in_first"].size(), 16U);
    EXPECT_NEAR(views["cameras"][0]["window"][2].get<double>(), (1280.0 - 650) / 700, 1e-6);
    EXPECT_EQ(views["corners"][5], json({0.1, 0.1, 0.0}));

    const json& left = shown["residuals"]["left_out"];
    EXPECT_EQ(left["configurations"]["id"], json(measured.ids));
    EXPECT_NEAR(left["configurations"]["joints"][3][2].get<double>(), measured.configurations(3, 2),
                5.1e-7);
    EXPECT_EQ(left["readings"]["configuration"], shown["residuals"]["readings"]["configuration"]);
    EXPECT_FALSE(shown["residuals"]["validation"].contains("configurations"));
}

TEST(ToPage, HasWhereAPlanIsExpectedToShowCorners) {
    const Campaign points = testing::tracked_campaign(testing::fanuc());
    const Campaign campaign = testing::before_camera(points, testing::fixed_camera());
    Plan plan;
    plan.poses = {{"a", VectorXd::Zero(6), 1, {2, 4, 7}}};
    EXPECT_FALSE(page_expected(points, plan));
    PagePart part = part_of("plan");
    part.expected = page_expected(campaign, plan);
    const json shown = json::parse(to_json(std::vector<PagePart>{part}))["parts"][0]["expected"];
    EXPECT_EQ(shown["readings"]["camera"], json({0, 0, 0}));
    const Measurements expected = expected_readings(campaign, plan);
    EXPECT_NEAR(shown["readings"]["place"][1][2].get<double>(), 1e3 * expected.observations(0, 15),
                0.0051);
    EXPECT_EQ(shown["images"][0]["counts"].size(), 48U);
    EXPECT_FALSE(shown["images"][0].contains("rms_px"));
}

TEST(WritePage, WritesAllOrNothing) {
    const TemporaryFolder folder;
    write_page(folder.path("a.html"), {part_of("a")});
    EXPECT_EQ(detail::read_file(folder.path("a.html")), to_page({part_of("a")}));
    PagePart wrong = part_of("a");
    wrong.document = "";
    EXPECT_NE(input_error_of([&] { write_page(folder.path("a.html"), {wrong}); }), "no error");
    EXPECT_EQ(detail::read_file(folder.path("a.html")), to_page({part_of("a")}));
    EXPECT_EQ(folder.file_count(), 1U);
    EXPECT_EQ(input_error_of([&] {
                  write_page(folder.path("no/a.html"), {part_of("a")});
              }).find("no/a.html: cannot be written"),
              0U);
}

TEST(KindOfSaved, IsFoundFromTheContent) {
    const TemporaryFolder folder;
    const auto kind_of = [&](const std::string& text) {
        return kind_of_saved(folder.write("f", text));
    };
    EXPECT_EQ(kind_of(R"({"kind": "posewise plan"})"), SavedKind::Plan);
    EXPECT_EQ(kind_of(R"({"kind": "posewise estimate"})"), SavedKind::Estimate);
    EXPECT_EQ(kind_of(R"({"kind": "posewise study"})"), SavedKind::Study);
    EXPECT_EQ(kind_of(R"({"kind": "posewise export"})"), SavedKind::Export);
    const auto error_of = [&](const std::string& text) {
        return input_error_of([&] { kind_of(text); });
    };
    EXPECT_EQ(error_of(R"({"kind": "posewise indices"})"),
              "f: kind: is 'posewise indices'; must be that of a plan, estimate, study or export, "
              "as posewise writes them, or the file a store of study");
    EXPECT_EQ(error_of("[1]").find("f: kind: is ''; must be"), 0U);
    EXPECT_EQ(error_of(R"({"kind": 3})"), "f: kind: is of type number; must be text");
    EXPECT_EQ(error_of("name: a"),
              "f:1:2: is not JSON here; must be a plan, estimate, study or export as posewise "
              "writes it");
}

TEST(ReadSavedDocument, NeedsWhatIsShownOfAStudy) {
    const TemporaryFolder folder;
    const auto error_of = [&](const std::string& first, const std::string& second) {
        const auto row = [](const std::string& planned) {
            return R"({"pose_count": 8, "planned": [)" + planned +
                   R"(], "random": {"held_out_rms_p10_mm": 1, "held_out_rms_p50_mm": 1,)"
                   R"("held_out_rms_p90_mm": 1, "subsets": 3, "unidentified": 0}})";
        };
        folder.write("s", R"({"kind": "posewise study", "format": 1, "campaign": "c",)"
                          R"("simulated": false, "models": [{"name": "full", "rows": [)" +
                              row(first) + ", " + row(second) + "]}]}");
        return input_error_of([&] { read_saved_document(folder.path("s"), SavedKind::Study); });
    };
    const auto chosen = [](const std::string& criterion) {
        return R"({"criterion": ")" + criterion +
               R"(", "held_out_rms_mm": 0.2, "expected_rms_mm": null})";
    };
    EXPECT_EQ(error_of(chosen("v"), chosen("v")), "no error");
    EXPECT_EQ(error_of(chosen("v"), ""),
              "s: models[0].rows[1].planned: is empty; must hold what each criterion chose");
    EXPECT_EQ(error_of(chosen("v"), chosen("d")),
              "s: models[0].rows[1].planned: is not by the criteria of the first row");
}

TEST(ReadSavedDocument, NeedsWhatIsShownOfAnExport) {
    const TemporaryFolder folder;
    const auto error_of = [&](const std::string& geometry, const std::string& files) {
        folder.write("x", R"({"kind": "posewise export", "format": 1, "campaign": "c",)"
                          R"("geometry": ")" +
                              geometry +
                              R"(", "lost": {"nominal":)"
                              R"({"rms_mm": 2, "largest_mm": 3}, "estimate": {"rms_mm": 0,)"
                              R"("largest_mm": 0}}, "not_exported": [], "read_back": [)" +
                              files + "]}");
        return input_error_of([&] { read_saved_document(folder.path("x"), SavedKind::Export); });
    };
    const std::string file =
        R"({"path": "a", "configurations": 9, "position_m": 0, "orientation_rad": 0})";
    EXPECT_EQ(error_of("estimate", file), "no error");
    EXPECT_EQ(error_of("estimate", ""), "x: read_back: is empty; must name the files written");
    EXPECT_EQ(error_of("nearest", file),
              "x: lost.nearest: is missing; must be there as posewise writes it");
}

TEST(ReadEstimateRecord, SaysWhatTheEstimateWasMadeFrom) {
    const TemporaryFolder folder;
    const Campaign campaign = testing::cell_campaign();
    const Measurements measured = simulate(campaign, {.pose_count = 14}).measurements;
    CalibrationOptions options;
    options.folds = 3;
    options.excluded = {"4"};
    options.joint.loss.kind = LossKind::Huber;
    const Calibration found = calibrate(campaign, measured, options);
    const Provenance made_from{"m.csv", "c2", "c.yaml", "c1", {{"--prior", {"true"}}}};
    write_estimate(folder.path("e.json"), found, made_from);
    const EstimateRecord record = read_estimate_record(folder.path("e.json"));
    EXPECT_EQ(record.campaign, campaign.name);
    EXPECT_EQ(record.made_from.measurements, "m.csv");
    EXPECT_EQ(record.made_from.measurements_checksum, "c2");
    EXPECT_EQ(record.made_from.campaign_file, "c.yaml");
    EXPECT_TRUE(record.has_option("--prior"));
    EXPECT_FALSE(record.has_option("--from"));
    EXPECT_EQ(record.excluded, options.excluded);
    EXPECT_EQ(record.folds, 3);
    EXPECT_EQ(record.loss.kind, LossKind::Huber);
    EXPECT_EQ(record.loss.width, found.estimate.loss.width);
    EXPECT_EQ(json::parse(read_saved_document(folder.path("e.json"), SavedKind::Estimate)),
              json::parse(to_json(found, made_from)));
}

}  // namespace
}  // namespace posewise::io
