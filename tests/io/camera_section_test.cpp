#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>

#include "../../src/model/sampling.hpp"
#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;
using testing::two_joint_arm;

const std::string camera =
    "sensor:\n"
    "  kind: camera\n"
    "  camera: flange\n"
    "  image_px: [1280, 960]\n"
    "  sigma_px: 0.25\n"
    "  intrinsics: {fx_px: 1210, fy_px: 1205, cx_px: 655, cy_px: 470, known: [cx, cy],\n"
    "    distortion: {model: brown_conrady, coefficients: [-0.1, 0.02, 0, 0]}}\n"
    "  board: {columns: 3, rows: 2, square_mm: 25}\n"
    "  place: {position_mm: [10, 20, 30], rpy_deg: [0, 0, 90]}\n"
    "  view: {most_tilt_deg: 45, least_corners: 5, front: +z}\n";

CampaignFile with_camera(const std::string& text) {
    return parse_campaign(two_joint_arm + text, "c.yaml");
}

const CameraSetup& setup_of(const Campaign& campaign) {
    return dynamic_cast<const CameraSensor&>(*campaign.sensor).setup();
}

TEST(ReadCamera, TakesWhatIsStated) {
    const Campaign campaign = with_camera(camera);
    const CameraSetup& setup = setup_of(campaign);
    EXPECT_TRUE(setup.is_on_flange);
    EXPECT_NEAR(setup.sigma, 0.25, 1e-12);
    EXPECT_NEAR(setup.intrinsics.fx, 1210, 1e-9);
    EXPECT_EQ(setup.intrinsics.distortion, Distortion::BrownConrady);
    EXPECT_EQ(setup.intrinsics.coefficients, (std::vector<double>{-0.1, 0.02, 0, 0}));
    EXPECT_EQ(setup.is_known,
              (std::vector<bool>{false, false, true, true, false, false, false, false}));
    ASSERT_EQ(setup.corners.size(), 6U);
    EXPECT_EQ(setup.corners[4], Vector3d(0.025, 0.025, 0));
    EXPECT_NEAR(setup.view.most_tilt, to_radians(45), 1e-15);
    EXPECT_EQ(setup.view.least_corners, 5);
    EXPECT_TRUE(setup.view.is_front_plus_z);
    EXPECT_TRUE(campaign.has_nominal_targets);
    EXPECT_NEAR(campaign.nominal.sensor[6], 1.21, 1e-12);  // 1000 px
    EXPECT_EQ(campaign.sensor->unknown_names()[6], "camera.fx");
}

TEST(ReadCamera, KnowsIntrinsicsWithDeviations) {
    const std::string stated = "known: [cy], deviations: {fx_px: 2, cx_px: 3, k1: 0.01}";
    const Campaign campaign = with_camera(replaced(camera, "known: [cx, cy]", stated));
    const CameraSetup& setup = setup_of(campaign);
    EXPECT_EQ(setup.is_known,
              (std::vector<bool>{true, false, true, true, true, false, false, false}));
    EXPECT_EQ(setup.deviations, (std::vector<double>{2e-3, 0, 3e-3, 0, 0.01, 0, 0, 0}));
    const auto names = campaign.sensor->unknown_names();
    const std::vector<std::string> first{"camera.dfx", "camera.dcx", "camera.dk1", "camera.x"};
    EXPECT_EQ(std::vector<std::string>(names.begin(), names.begin() + 4), first);
    EXPECT_EQ(campaign.sensor->unknown_sizes(), Vector3d(2e-3, 3e-3, 0.01));
    EXPECT_EQ(campaign.nominal.sensor.head<3>(), Vector3d::Zero());
    const auto& sensor = dynamic_cast<const CameraSensor&>(*campaign.sensor);
    VectorXd unknowns = campaign.nominal.sensor;
    unknowns[0] = 1e-3;  // 1 px
    EXPECT_NEAR(sensor.intrinsics(unknowns).fx, 1211, 1e-9);
    const auto error = [&](const std::string& bad) {
        return input_error_of([&] { with_camera(replaced(camera, "known: [cx, cy]", bad)); });
    };
    EXPECT_NE(error("deviations: {fx: 2}").find("is of no intrinsic parameter; must be fx_px"),
              std::string::npos);
    EXPECT_NE(error("deviations: {fx_px: 0}").find("must be above 0"), std::string::npos);
    EXPECT_NE(error("deviations: {k3: 1}").find("is of no intrinsic parameter"), std::string::npos);
    for (const std::string known : {"[fx, cx]", "true"}) {
        EXPECT_NE(error("known: " + known + ", deviations: {k1: 1, fx_px: 2}")
                      .find(known == "true" ? "deviations.k1 is stated beside 'known', by which k1"
                                            : "deviations.fx_px is stated beside 'known', by which "
                                              "fx is exact; must stand in one of them"),
                  std::string::npos)
            << error("known: " + known + ", deviations: {k1: 1, fx_px: 2}");
    }
    EXPECT_NE(error("deviations: {}").find("is empty; must state one"), std::string::npos);
    const Campaign others =
        with_camera(replaced(camera, "known: [cx, cy]", "known: false, deviations: {cx_px: 3}"));
    EXPECT_EQ(setup_of(others).is_known,
              (std::vector<bool>{false, false, true, false, false, false, false, false}));
}

/// The image of 1280 x 960 px reaches 0.4 to the side; there it would turn back with -3.
TEST(ReadCamera, RefusesALensThatFoldsWithinTheImage) {
    const auto error = [](const std::string& coefficients) {
        return input_error_of(
            [&] { with_camera(replaced(camera, "[-0.1, 0.02, 0, 0]", coefficients)); });
    };
    const std::string found = error("[-3, 0, 0, 0]");
    EXPECT_TRUE(found.starts_with("c.yaml:")) << found;
    EXPECT_NE(found.find("sensor.intrinsics.distortion folds the image onto itself from 26"),
              std::string::npos)
        << found;
    EXPECT_NE(found.find("within the image, whose nearest edge is 470 px away"), std::string::npos);
    EXPECT_EQ(error("[-0.3, 0, 0, 0]"), "no error");
    const std::string wide = replaced(camera, "  image_px: [1280, 960]\n", "");
    EXPECT_NO_THROW(with_camera(replaced(wide, "[-0.1, 0.02, 0, 0]", "[-3, 0, 0, 0]")));
}

TEST(ReadCamera, TakesHowNoiseGrowsAndHowFarItSees) {
    EXPECT_TRUE(setup_of(with_camera(camera)).growth.is_none());
    const std::string grown =
        replaced(camera, "sigma_px: 0.25",
                 "sigma_px: 0.25\n  noise: {tilt: 1, focus_mm: 600, aperture_mm: 4.5}");
    const Campaign campaign = with_camera(
        replaced(grown, "front: +z", "nearest_mm: 250, farthest_mm: 900, line_of_sight: false") +
        "  other_cameras: [{intrinsics: {fx_px: 600, fy_px: 600}, noise: {tilt: 0.5}}]\n");
    const CameraSetup& setup = setup_of(campaign);
    EXPECT_EQ(setup.growth.tilt, 1);
    EXPECT_NEAR(*setup.growth.focus, 0.6, 1e-15);
    EXPECT_NEAR(setup.growth.aperture, 4.5e-3, 1e-15);
    EXPECT_EQ(setup.others[0].growth.tilt, 0.5);
    EXPECT_EQ(setup.others[0].growth.focus, setup.growth.focus);
    EXPECT_NEAR(setup.view.nearest, 0.25, 1e-15);
    EXPECT_NEAR(setup.view.farthest, 0.9, 1e-15);
    EXPECT_FALSE(setup.view.is_line_required);
    EXPECT_NE(
        campaign.sensor->words().sentence.find(
            "sigma 0.25 px, growing with tilt and distance from focus, seen from 250 mm to 900 mm"),
        std::string::npos);
}

TEST(ReadCamera, LearnsSizesOnlyIfTold) {
    EXPECT_FALSE(with_camera(camera).spread.is_open);
    EXPECT_TRUE(with_camera(camera + "sizes: learned\n").spread.is_open);
}

TEST(ReadCamera, FindsWhatItIsNotTold) {
    const Campaign campaign = with_camera(
        "sensor: {kind: camera, camera: fixed, sigma_px: 0.3, intrinsics: {known: false},\n"
        "  board: {points_mm: [[0, 0, 0], [50, 0, 0], [50, 50, 0], [0, 50, 20]]}}\n");
    EXPECT_FALSE(campaign.has_nominal_targets);
    EXPECT_FALSE(setup_of(campaign).is_on_flange);
    EXPECT_EQ(setup_of(campaign).intrinsics.fx, 0);
    EXPECT_EQ(campaign.sensor->unknown_names().size(), 10U);
}

TEST(ReadCamera, SaysWhatIsWrong) {
    const auto expect_error = [](const std::string& good, const std::string& bad,
                                 const std::string& message) {
        const std::string error = input_error_of([&] { with_camera(replaced(camera, good, bad)); });
        EXPECT_NE(error.find(message), std::string::npos) << error;
        EXPECT_EQ(error.substr(0, 7), "c.yaml:") << error;
    };
    expect_error("camera: flange", "camera: hand", "must be flange or fixed");
    expect_error("sigma_px: 0.25", "sigma_px: 0", "must be positive");
    expect_error("sigma_px: 0.25", "sigma_mm: 0.25", "sigma_mm");
    expect_error("fx_px: 1210", "fx_px: -1210", "is negative");
    expect_error("fx_px: 1210, ", "", "one focal length");
    expect_error("brown_conrady", "plumb_bob", "must be none, brown_conrady or fisheye");
    expect_error("[-0.1, 0.02, 0, 0]", "[-0.1, 0.02, 0]", "has 3 numbers");
    expect_error("known: [cx, cy]", "known: [cz]", "cz");
    expect_error("columns: 3", "columns: 1", "must be from 2");
    expect_error("columns: 3, rows: 2, ", "", "must have either columns");
    expect_error("most_tilt_deg: 45", "most_tilt_deg: 100", "must be");
    expect_error("least_corners: 5", "least_corners: 7",
                 "must be from 1 to 6, the board's corners");
    expect_error("front: +z", "front: up", "must be -z or +z");
    expect_error("front: +z", "nearest_mm: 900, farthest_mm: 250", "not beyond nearest_mm");
    expect_error("front: +z", "nearest_mm: -1", "must be zero or positive");
    EXPECT_NO_THROW(with_camera(replaced(camera, "front: +z", "nearest_mm: 0")));
    expect_error("least_corners: 5", "least_corners: -5", "must be a whole number from 1 to 6");
    expect_error("columns: 3", "columns: x", "must be a whole number from 2 to 1000");
    expect_error("square_mm: 25", "square_mm: 25, first_point: 9223372036854775808",
                 "must be from 0 to 1");
    expect_error(
        "square_mm: 25", "square_mm: 1e-9",
        "square_mm is '1e-9'; must be from 0.2 to 10000 mm, as what can be printed (in metres "
        "its key ends in _m)");
    const std::string sigma = "sigma_px: 0.25";
    expect_error(sigma, sigma + "\n  noise: {focus_mm: 600}", "both focus_mm and aperture_mm");
    expect_error(sigma, sigma + "\n  noise: {tilt: 9}", "noise.tilt is 9, must be from 0 to 4");
    expect_error(sigma, sigma + "\n  noise: {range_um: 9}", "unknown key 'range_um'");
    expect_error(sigma, sigma + "\n  noise: {}", "noise is empty; must state tilt, or focus_mm");
    expect_error("[1280, 960]", "[1280, 0]", "a whole number of pixels, at least 1");
    expect_error("[1280, 960]", "[1280.5, 960]", "a whole number of pixels, at least 1");
    expect_error("{columns: 3, rows: 2, square_mm: 25}",
                 "{points_mm: [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 0, 0]]}",
                 "in one line");
    expect_error("{columns: 3, rows: 2, square_mm: 25}",
                 "{points_mm: [[0, 0, 0], [1, 0, 0], [1, 0, 0], [3, 0, 1]]}",
                 "at the place of point 2");
}

// ---- Boards ----

/// The setup of a camera before this board; `content` is that of the file board.yaml.
CameraSetup before(const std::string& board, const std::string& content = "") {
    const TemporaryFolder folder;
    folder.write("board.yaml", content);
    return setup_of(read_campaign(
        folder.write("c.yaml", two_joint_arm +
                                   "sensor: {kind: camera, camera: fixed, sigma_px: 0.3,\n"
                                   "  intrinsics: {known: false}, board: " +
                                   board + "}\n")));
}

TEST(ReadBoard, SaysThatAFileIsEmptyWhereItIsNamed) {
    for (const std::string empty : {"", "# nothing\n\n", "%YAML:1.0\n---\n"}) {
        const std::string error = input_error_of([&] { before("{file: board.yaml}", empty); });
        EXPECT_TRUE(error.starts_with("c.yaml:")) << error;
        EXPECT_NE(error.find("sensor.board.file cannot be used: "), std::string::npos) << error;
        EXPECT_NE(error.find("board.yaml is empty; must describe what"), std::string::npos)
            << error;
    }
}

void expect_places(const CameraSetup& setup, std::size_t count,
                   const std::vector<std::pair<std::size_t, Vector3d>>& places) {
    ASSERT_EQ(setup.corners.size(), count);
    for (const auto& [k, place] : places) {
        EXPECT_LT((setup.corners[k] - place).norm(), 1e-12) << k;
    }
}

const std::string charuco = "{kind: charuco, columns: 5, rows: 7, square_mm: 30, marker_mm: 22}";
const std::string aprilgrid = "{kind: aprilgrid, columns: 3, rows: 2, tag_mm: 50, spacing: 0.3}";

TEST(ReadBoard, TakesInnerCornersOfACharucoBoardByItsIds) {
    const CameraSetup setup = before(charuco);
    // As CharucoBoard::chessboardCorners has them.
    expect_places(setup, 24, {{0, {0.03, 0.03, 0}}, {1, {0.06, 0.03, 0}}, {4, {0.03, 0.06, 0}}});
    EXPECT_EQ(setup.pattern.kind, BoardPattern::Kind::Charuco);
    EXPECT_EQ(setup.pattern.columns, 5);
    EXPECT_NEAR(setup.pattern.marker, 0.022, 1e-15);
    EXPECT_EQ(setup.pattern.dictionary, "DICT_4X4_50");
    EXPECT_EQ(setup.first_corner, 0);
    EXPECT_FALSE(setup.view.is_front_plus_z);
}

TEST(ReadBoard, TakesCharucoBoardsOfOldOpenCv) {
    const std::string old =
        replaced(replaced(charuco, "rows: 7", "rows: 8"), "22}", "22, legacy: true}");
    EXPECT_TRUE(before(old).pattern.is_legacy);
    EXPECT_FALSE(before(charuco).pattern.is_legacy);
}

TEST(ReadBoard, CountsTagCornersAsKalibrDoes) {
    const CameraSetup setup = before(aprilgrid);
    // Row by row of corners from the lower left: 6 in a row, the second tag 65 mm from the first.
    expect_places(setup, 24,
                  {{0, {0, 0, 0}},
                   {1, {0.05, 0, 0}},
                   {2, {0.065, 0, 0}},
                   {6, {0, 0.05, 0}},
                   {12, {0, 0.065, 0}},
                   {23, {0.18, 0.115, 0}}});
    EXPECT_EQ(setup.first_corner, 0);
    EXPECT_TRUE(setup.view.is_front_plus_z);
}

TEST(ReadBoard, TakesTargetFilesOfKalibr) {
    const std::string kalibr_grid =
        "target_type: 'aprilgrid' #gridtype\ntagCols: 3\ntagRows: 2\ntagSize: 0.05\n"
        "tagSpacing: 0.3  #ratio\n";
    EXPECT_EQ(before("{file: board.yaml}", kalibr_grid).corners, before(aprilgrid).corners);
    const std::string checkerboard =
        "target_type: 'checkerboard'\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
        "colSpacingMeters: 0.05\n";
    const CameraSetup setup = before("{file: board.yaml, sigma_mm: 0.3}", checkerboard);
    expect_places(setup, 42, {{1, {0.05, 0, 0}}, {6, {0, 0.06, 0}}});
    EXPECT_EQ(setup.pattern.kind, BoardPattern::Kind::Chessboard);
    EXPECT_EQ(setup.pattern.rows, 7);
    EXPECT_NEAR(setup.corner_sigma, 3e-4, 1e-15);
}

TEST(ReadBoard, TakesAFileWithTheCampaignsOwnKeys) {
    const std::string content = "board: {columns: 3, rows: 2, square_mm: 25, first_point: 0}\n";
    const CameraSetup setup = before("{file: board.yaml}", content);
    EXPECT_EQ(setup.corners, before("{columns: 3, rows: 2, square_mm: 25}").corners);
    EXPECT_EQ(setup.first_corner, 0);
    EXPECT_EQ(before("{file: board.yaml, first_point: 1}", content).first_corner, 1);
}

const std::string settings_xml =
    "<?xml version=\"1.0\"?>\n<opencv_storage>\n<Settings>\n  <BoardSize_Width> 9"
    "</BoardSize_Width>\n  <BoardSize_Height>6</BoardSize_Height>\n  <Square_Size>50</Square_Size>"
    "\n  <Calibrate_Pattern>\"CHESSBOARD\"</Calibrate_Pattern>\n</Settings>\n</opencv_storage>\n";
const std::string settings_yaml =
    "%YAML:1.0\n---\nSettings:\n   BoardSize_Width: 9\n   BoardSize_Height: 6\n"
    "   Square_Size: 5.\n   Calibrate_Pattern: \"CHESSBOARD\"\n";
const std::string result_yaml =
    "%YAML:1.0\n---\ncalibration_time: \"Thu 01 Jan 2026\"\nboard_width: 9\nboard_height: 6\n"
    "square_size: 5.0000000745058060e-02\ncamera_matrix: !!opencv-matrix\n   rows: 1\n   cols: 1\n"
    "   dt: d\n   data: [ 1. ]\n";

/// In mm, cm and m, which they do not say.
TEST(ReadBoard, TakesWhatOpenCvWritesWithItsUnit) {
    for (const std::string& content : {settings_xml, settings_yaml, result_yaml}) {
        const CameraSetup setup = before("{file: board.yaml, square_mm: 50}", content);
        EXPECT_EQ(setup.pattern.kind, BoardPattern::Kind::Chessboard);
        EXPECT_EQ(setup.first_corner, 1);
        expect_places(setup, 54, {{0, {0, 0, 0}}, {10, {0.05, 0.05, 0}}, {53, {0.4, 0.25, 0}}});
    }
}

TEST(ReadBoard, SaysWhatIsWrongInFilesOfOpenCv) {
    const auto expect_error = [](const std::string& content, const std::string& message,
                                 const std::string& board = "{file: board.yaml, square_mm: 50}") {
        const std::string error = input_error_of([&] { before(board, content); });
        EXPECT_NE(error.find(message), std::string::npos) << error;
    };
    expect_error(settings_xml, "squares of 50, in a unit that OpenCV does not write",
                 "{file: board.yaml}");
    expect_error(settings_yaml, "the file says 5; must be that in mm, cm or m",
                 "{file: board.yaml, square_mm: 25}");
    for (const std::string& settings : {settings_xml, settings_yaml}) {
        expect_error(replaced(settings, "CHESSBOARD", "CIRCLES_GRID"), "must be CHESSBOARD");
        expect_error(replaced(settings, settings == settings_xml ? " 9" : " 9\n", " 1\n"),
                     "must be from 2");
    }
    expect_error(replaced(settings_xml, ">50<", ">none<"), "has no Square_Size");
    expect_error(replaced(settings_xml, ">6<", ">6.5<"), "has no BoardSize_Height");
    expect_error(replaced(settings_yaml, "   Square_Size: 5.\n", ""), "no key 'Square_Size'");
    expect_error("<a><b/></a>", "BoardSize_Width");
    expect_error("<a><b>", "board.yaml:1");
    expect_error("board: {columns: 3, rows: 2, square_mm: 25}\n", "must be left out");
}

/// A named pipe that nobody writes to would be waited for.
TEST(ReadBoard, WaitsForNoPipe) {
    const TemporaryFolder folder;
    ASSERT_EQ(::mkfifo(folder.path("pipe").c_str(), 0600), 0);
    const std::string arm =
        two_joint_arm + "sensor: {kind: camera, camera: fixed, sigma_px: 0.3,\n";
    for (const std::string pipe :
         {"  intrinsics: {known: false}, board: {file: pipe}}\n",
          "  intrinsics: {file: pipe}, board: {columns: 3, rows: 2, square_mm: 25}}\n"}) {
        const std::string path = folder.write("c.yaml", arm + pipe);
        const std::string error = input_error_of([&] { read_campaign(path); });
        EXPECT_NE(error.find("is no regular file"), std::string::npos) << error;
    }
}

TEST(ReadBoard, SaysWhatIsWrong) {
    const auto expect_error = [](const std::string& board, const std::string& message,
                                 const std::string& content = "") {
        const std::string error = input_error_of([&] { before(board, content); });
        EXPECT_NE(error.find(message), std::string::npos) << error;
    };
    expect_error("{columns: 5, rows: 7, square_mm: 30, marker_mm: 22}", "must state kind: charuco");
    expect_error("{columns: 3, rows: 2, tag_mm: 50}", "must state kind: aprilgrid");
    expect_error("{columns: 5, points_mm: []}", "unknown key 'columns'");
    expect_error("{kind: circles}", "kind is 'circles'; must be");
    expect_error("{columns: 50, rows: 50, square_mm: 3}", "has 2500 corners; must have at most");
    expect_error(replaced(charuco, "columns: 5", "columns: 2"), "must be from 3");
    expect_error(replaced(charuco, "marker_mm: 22", "marker_mm: 30"), "smaller than the squares");
    expect_error(replaced(charuco, "marker_mm: 22", "marker_mm: 28"),
                 "marker_mm is '28' of squares of 30; must be at most 0.9");
    EXPECT_EQ(before(replaced(charuco, "marker_mm: 22", "marker_mm: 27")).pattern.marker, 0.027);
    expect_error(replaced(charuco, "22}", "22, dictionary: 4X4}"), "such as DICT_4X4_50");
    expect_error(replaced(charuco, "22}", "22, spacing: 0.3}"), "unknown key 'spacing'");
    expect_error(replaced(charuco, "22}", "22, legacy: true}"), "odd number of rows");
    expect_error(replaced(aprilgrid, "0.3", "15"), "divided by a tag's side");
    const std::string from_file = "{file: board.yaml}";
    expect_error("{file: none.yaml}", "cannot be read");
    expect_error("{file: board.yaml, columns: 3}", "unknown key 'columns'");
    expect_error(from_file, "neither target_type", "columns: 3\n");
    expect_error(from_file, "must describe the board itself", "board: {file: board.yaml}\n");
    expect_error(from_file, "must be checkerboard or aprilgrid", "target_type: circlegrid\n");
    const std::string tags = "target_type: aprilgrid\ntagCols: 3\ntagRows: 2\n";
    expect_error(from_file, "board.yaml:1:1: the file has no key 'tagSize'", tags);
    expect_error(from_file, "codeOffset", tags + "tagSize: 0.05\ntagSpacing: 0.3\ncodeOffset: 9\n");
}

// ---- Cameras from files ----

const std::string opencv =
    "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 960\n"
    "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
    "   data: [ 1210., 0., 655., 0., 1205., 470., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
    "   data: [ -0.1, 0.02, 1.0e-03, 0., 0.01 ]\n";
const std::string kalibr =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [1210, 1205, 655, 470]\n"
    "  distortion_model: equidistant\n  distortion_coeffs: [0.1, 0.02, 0, 0]\n"
    "  resolution: [1280, 960]\n  rostopic: /cam0/image_raw\n";

CampaignFile read_with_file(const std::string& text, const std::string& change = "") {
    const TemporaryFolder folder;
    folder.write("camera.yaml", text);
    return read_campaign(folder.write(
        "c.yaml", two_joint_arm + "sensor: {kind: camera, camera: fixed, sigma_px: 0.3, " + change +
                      "intrinsics: {file: camera.yaml},\n"
                      "  board: {columns: 3, rows: 2, square_mm: 25}}\n"));
}

TEST(ReadCamera, TakesEachCameraFromAFileOfSeveral) {
    const std::string others = "other_cameras: [{intrinsics: {file: camera.yaml}}], ";
    const std::string second =
        "camera2_image_width: 640\ncamera2_image_height: 480\n"
        "camera2_matrix: {data: [600, 0, 320, 0, 601, 240, 0, 0, 1]}\n"
        "camera2_distortion_model: fisheye\n"
        "camera2_distortion_coefficients: {data: [0.1, 0.02, 0, 0]}\n";
    const CampaignFile of_opencv = read_with_file(opencv + second, others);
    EXPECT_EQ(setup_of(of_opencv).intrinsics.fy, 1205);
    EXPECT_EQ(setup_of(of_opencv).others[0].intrinsics.fy, 601);
    EXPECT_EQ(setup_of(of_opencv).others[0].intrinsics.distortion, Distortion::Fisheye);
    EXPECT_EQ(*setup_of(of_opencv).others[0].image, Vector2d(640, 480));
    const std::string of_kalibr =
        kalibr + "cam1: {camera_model: pinhole, intrinsics: [600, 601, 320, 240]}\n";
    EXPECT_EQ(setup_of(read_with_file(of_kalibr, others)).others[0].intrinsics.fy, 601);
    // A file of one camera may be of any.
    EXPECT_EQ(setup_of(read_with_file(opencv, others)).others[0].intrinsics.fy, 1205);
}

TEST(ReadCamera, TakesFilesOfOpenCvAndKalibr) {
    const CampaignFile of_opencv = read_with_file(opencv);
    const CameraSetup& setup = setup_of(of_opencv);
    EXPECT_EQ(setup.intrinsics.fy, 1205);
    EXPECT_EQ(setup.intrinsics.cx, 655);
    EXPECT_EQ(setup.intrinsics.coefficients, (std::vector<double>{-0.1, 0.02, 1e-3, 0, 0.01}));
    EXPECT_EQ(*setup.image, Vector2d(1280, 960));
    const CampaignFile of_kalibr = read_with_file(kalibr);
    EXPECT_EQ(setup_of(of_kalibr).intrinsics.distortion, Distortion::Fisheye);
    EXPECT_EQ(setup_of(of_kalibr).intrinsics.cy, 470);
}

TEST(ReadCamera, RefusesFilesOfAnotherImageOrAnotherModel) {
    const auto error_of = [](const std::string& text, const std::string& change = "") {
        return input_error_of([&] { read_with_file(text, change); });
    };
    EXPECT_NE(error_of(opencv, "image_px: [640, 480], ").find("neither scaled nor turned"),
              std::string::npos);
    EXPECT_NE(error_of(replaced(opencv, "1.0e-03, 0., 0.01", "0, 0, 1, 2, 3, 4, 5, 6, 7, 8"))
                  .find("coefficients"),
              std::string::npos);
    EXPECT_NE(error_of(replaced(kalibr, "pinhole", "omni")).find("must be pinhole"),
              std::string::npos);
    EXPECT_NE(error_of("image_width: 3\n").find("camera_matrix"), std::string::npos);
    EXPECT_NE(error_of(opencv.substr(0, opencv.find("distortion_coefficients")))
                  .find("as if it were cut off"),
              std::string::npos);
    EXPECT_NE(error_of(replaced(opencv, "[ 1210.", "[ -1210.")).find("must be above 0"),
              std::string::npos);
}

// ---- Corners ----

Measurements corners(const std::string& text, const std::string& campaign = camera) {
    const TemporaryFolder folder;
    return read_measurements_csv(folder.write("m.csv", text), with_camera(campaign));
}

TEST(ReadCorners, TakesARowForEachInAnyOrder) {
    const Measurements measured = corners(
        "config,q1_deg,q2_deg,point,u_px,v_px\n"
        "a,10,20,2,640,480\n"
        "b,11,20,1,100,200\n"
        "a,10,20,6,700.5,500\n"
        "a,10,20,3,,\n"
        "b,11,20,4,nan,NaN\n");
    EXPECT_EQ(measured.ids, (std::vector<std::string>{"a", "b"}));
    ASSERT_EQ(measured.observations.cols(), 12);
    EXPECT_EQ(measured.is_seen.row(0).count(), 2);
    EXPECT_TRUE(measured.is_seen(0, 1));
    EXPECT_TRUE(measured.is_seen(0, 5));
    EXPECT_EQ(measured.observations(0, 2), 0.64);
    EXPECT_EQ(measured.observations(0, 10), 0.7005);
    EXPECT_EQ(measured.observations(1, 1), 0.2);
}

const std::string two_cameras =
    camera +
    "  other_cameras:\n"
    "    - {image_px: [640, 480], intrinsics: {fx_px: 600, fy_px: 600, cx_px: 320, cy_px: 240},\n"
    "       place: {position_mm: [100, 0, 0], rpy_deg: [0, 5, 0]}}\n";

TEST(ReadCamera, TakesFurtherCameras) {
    const Campaign campaign = with_camera(two_cameras);
    const CameraSetup& setup = setup_of(campaign);
    ASSERT_EQ(setup.others.size(), 1U);
    EXPECT_EQ(setup.others[0].sigma, setup.sigma);
    EXPECT_EQ(*setup.others[0].image, Vector2d(640, 480));
    EXPECT_EQ(campaign.sensor->target_count(), 12);
    EXPECT_TRUE(campaign.has_nominal_targets);
    const auto names = campaign.sensor->unknown_names();
    const auto place = std::find(names.begin(), names.end(), "camera2.x") - names.begin();
    EXPECT_NEAR(campaign.nominal.sensor[place], 0.1, 1e-15);
    EXPECT_FALSE(
        with_camera(replaced(two_cameras,
                             ",\n       place: {position_mm: [100, 0, 0], rpy_deg: [0, 5, 0]}", ""))
            .has_nominal_targets);
}

/// Where no base is stated, what is identifiable is judged with the board before the cameras.
TEST(ReadCamera, StandsBeforeTheRobotWhereNoBaseIsStated) {
    const std::string two = R"(
name: arm
robot:
  class: industrial
  joints: {q1: {limits_deg: [-40, -9]}, q2: {limits_deg: [12, 57]}, q3: {limits_deg: [-57, -6]},
    q4: {limits_deg: [-75, -50]}, q5: {limits_deg: [-4, 18]}, q6: {limits_deg: [-90, -48]}}
  elements: [Rz q1, Tz 1400 mm, Tx 150 mm, Rx -90 deg, Rz q2, Rz -90 deg, Tx 600 mm, Rx 180 deg,
    Rz q3, Tx 200 mm, Rx -90 deg, Rz q4, Tz -640 mm, Rx 90 deg, Rz q5, Rx 90 deg, Rz q6, Tz 200 mm]
sensor:
  kind: camera
  camera: fixed
  sigma_px: 1
  image_px: [1280, 960]
  intrinsics: {fx_px: 1200, fy_px: 1200, cx_px: 640, cy_px: 480, known: false}
  other_cameras: [{intrinsics: {fx_px: 1200, fy_px: 1200, cx_px: 640, cy_px: 480, known: false}}]
  board: {points_mm: [[0, 0, 0], [50, 0, 0], [0, 50, 0], [50, 50, 0], [20, 30, 50], [0, 40, 20]]}
)";
    const TemporaryFolder folder;
    const CampaignFile campaign = read_campaign(folder.write("c.yaml", two));
    EXPECT_FALSE(campaign.has_nominal_base);
    EXPECT_NO_THROW(check_knowable(campaign));
    VectorXd clearances(campaign.sensor->target_count());
    Index in_view = 0;
    const RowMatrixXd drawn = detail::random_configurations(campaign.robot, 20, 3);
    for (Index i = 0; i < drawn.rows(); ++i) {
        campaign.sensor->view_clearances(
            world_from_flange(campaign, campaign.nominal, drawn.row(i).transpose()),
            campaign.nominal.sensor, clearances);
        if (clearances.minCoeff() >= 0) ++in_view;
    }
    EXPECT_GT(in_view, 15);
}

TEST(ReadCamera, TakesHowWellMarkersAreKnown) {
    const Campaign campaign =
        with_camera(replaced(camera, "square_mm: 25", "square_mm: 25, sigma_mm: 0.3"));
    EXPECT_NEAR(setup_of(campaign).corner_sigma, 3e-4, 1e-15);
    EXPECT_EQ(campaign.sensor->unknown_names().front(), "board.p1.x");
}

TEST(ReadCorners, OfSeveralCamerasSayWhichSawThem) {
    const std::string header = "config,q1_deg,q2_deg,point,u_px,v_px,camera\n";
    const Measurements measured =
        corners(header + "a,10,20,2,600,400,2\na,10,20,2,1200,900,1\n", two_cameras);
    EXPECT_TRUE(measured.is_seen(0, 1));
    EXPECT_TRUE(measured.is_seen(0, 7));
    EXPECT_EQ(measured.is_seen.count(), 2);
    EXPECT_EQ(measured.observations(0, 14), 0.6);
    const TemporaryFolder folder;
    const std::string path = folder.write("m.csv", "");
    write_measurements_csv(path, with_camera(two_cameras), measured, {});
    const Measurements again = read_measurements_csv(path, with_camera(two_cameras));
    EXPECT_TRUE((again.is_seen == measured.is_seen).all());
    const auto error_of = [&](const std::string& row, const std::string& campaign) {
        return input_error_of([&] { corners(header + row, campaign); });
    };
    EXPECT_NE(error_of("a,10,20,2,600,400,3\n", two_cameras).find("a camera, 1 to 2"),
              std::string::npos);
    EXPECT_NE(error_of("a,10,20,2,700,400,2\n", two_cameras).find("must be from 0 to 640"),
              std::string::npos);
    EXPECT_NE(error_of("a,10,20,2,600,400,2\na,10,20,2,600,400,2\n", two_cameras)
                  .find("corner 2 of camera 2 of configuration"),
              std::string::npos);
    EXPECT_NE(error_of("a,10,20,2,600,400,2\n", camera).find("sensor.other_cameras"),
              std::string::npos);
    EXPECT_NE(input_error_of([&] {
                  corners("config,q1_deg,q2_deg,point,u_px,v_px\na,10,20,2,1,2\n", two_cameras);
              }).find("missing column camera"),
              std::string::npos);
}

TEST(ReadCorners, CountsFromZeroWhereTheCampaignSaysSo) {
    const std::string from_zero =
        replaced(camera, "square_mm: 25", "square_mm: 25, first_point: 0");
    const Measurements measured =
        corners("config,q1_deg,q2_deg,point,u_px,v_px\na,10,20,0,640,480\n", from_zero);
    EXPECT_TRUE(measured.is_seen(0, 0));
}

TEST(ReadCorners, TakesAViewARow) {
    const Measurements measured = corners(
        "config,q1_deg,q2_deg,p1_u_px,p1_v_px,p2_u_px,p2_v_px,p3_u_px,p3_v_px,p4_u_px,p4_v_px,"
        "p5_u_px,p5_v_px,p6_u_px,p6_v_px\n"
        "a,10,20,1,2,3,4,,,7,8,9,10,11,12\n");
    EXPECT_EQ(measured.is_seen.row(0).count(), 5);
    EXPECT_FALSE(measured.is_seen(0, 2));
    EXPECT_EQ(measured.observations(0, 11), 0.012);
}

TEST(ReadCorners, AreWrittenAsTheyAreRead) {
    const CampaignFile campaign = with_camera(camera);
    const Measurements measured = corners(
        "config,sample,q1_deg,q2_deg,point,u_px,v_px\n"
        "a,0,10,20,2,640.25,480\na,0,10,20,3,641,480\na,1,10,20,2,640,481\nb,0,11,20,1,100,200\n");
    const TemporaryFolder folder;
    const std::string path = folder.write("m.csv", "");
    write_measurements_csv(path, campaign, measured, {});
    const Measurements again = read_measurements_csv(path, campaign);
    EXPECT_EQ(again.first_sample, measured.first_sample);
    EXPECT_LT((again.observations - measured.observations).norm(), 1e-15);
    EXPECT_TRUE((again.is_seen == measured.is_seen).all());
}

TEST(ReadCorners, SayWhatIsWrongWhereItStands) {
    const auto expect_error = [](const std::string& row, const std::string& message) {
        const std::string error = input_error_of([&] {
            corners("config,q1_deg,q2_deg,point,u_px,v_px\na,10,20,2,640,480\n" + row + '\n');
        });
        EXPECT_NE(error.find(message), std::string::npos) << error;
        EXPECT_NE(error.find("m.csv:3:"), std::string::npos) << error;
    };
    expect_error("a,10,20,7,640,480", "corner of the board, 1 to 6");
    expect_error("a,10,20,0,640,480", "first_point: 0");
    expect_error("a,10,20,1.5,640,480", "corner of the board");
    expect_error("a,10,20,x,640,480", "corner of the board");
    expect_error("a,10,20,2,640,480", "occurs twice");
    expect_error("a,10,21,3,640,480", "other joint values in line 2");
    expect_error("a,10,20,3,1300,480", "outside of the image; must be from 0 to 1280");
    expect_error("a,10,20,3,480,1200", "are u and v swapped?");
    expect_error("a,10,20,3,,480", "must be a finite number");
}

TEST(ReadCorners, NameTheColumnsThatAreMissing) {
    const std::string error =
        input_error_of([&] { corners("config,q1_deg,q2_deg,u_px,v_px\na,10,20,640,480\n"); });
    EXPECT_NE(error.find("missing column point"), std::string::npos) << error;
}

}  // namespace
}  // namespace posewise::io
