#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/dh.hpp"
#include "posewise/task/answers.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/doubts.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/scene.hpp"
#include "posewise/task/study.hpp"

/// Results of tasks as JSON documents for other programs: what the program prints with --json.
/// designs/json.md explains every key. Keys contain the units; numbers have enough digits to read
/// them back exactly; what is infinite or unknown is null. All functions throw InputError if a name
/// or id is not UTF-8.
namespace posewise::io {

/// The document with these sentences as its `warnings` and, if there are any to state, its
/// `answers`, replacing those it has. Throws InputError if it is no JSON object.
std::string with_sentences(const std::string& document, const std::vector<std::string>& warnings,
                           const std::optional<std::vector<Answer>>& answers = std::nullopt);

std::string to_json(const Inspection& inspection);

/// With the readings of measurements that were tried, the best fitting first.
std::string to_json(const Inspection& inspection, const ReadingSearch& readings);

std::string to_json(const Rating& rating, const Campaign& campaign);
/// As above for plain blocks; `names` has one for each parameter.
std::string to_json(const Rating& rating, const std::vector<std::string>& names, bool has_prior);

/// The plan as in its file `path`, that file, and the predictions.
std::string to_json(const Plan& plan, const std::string& path);
/// As above, with how the planning went, the accuracy of other numbers of poses, and its
/// verification by simulation, if any.
std::string to_json(const Planning& planning, const std::vector<CountAccuracy>& counts,
                    const std::string& path,
                    const std::optional<SimulatedPlan>& simulated = std::nullopt);

/// As above for a plan that keeps a target, with what other numbers of poses reach.
std::string to_json(const TargetPlanning& found, const std::string& path,
                    const std::optional<SimulatedPlan>& simulated = std::nullopt);

std::string to_json(const ApproximateDesign& design);

/// For the plan in the file `path`.
std::string to_json(const Verification& verification, const Plan& plan, const std::string& path);

/// As write_estimate() writes it. The calibration must be identified.
std::string to_json(const Calibration& calibration, const Provenance& made_from);

/// For one error model, or several (compare_models()).
std::string to_json(const std::vector<Study>& studies);

std::string to_json(const BlocksStudy& study);

std::string to_json(const Simulation& simulation, const Campaign& campaign);

/// `left` are the lines of a program whose targets stay as they are.
std::string to_json(const CorrectedPoses& poses, const Campaign& campaign,
                    const std::vector<long>& left = {});

/// A written file and how it differs when read back.
struct ReadBack {
    std::string path;
    FlangeDifference difference;
};

/// A calibrated robot in formats for other programs.
struct ExportedRobot {
    /// Error terms that are not zero; none of the formats can express them.
    std::vector<std::string> terms;
    Geometry estimated;               ///< without error terms
    std::optional<Geometry> nearest;  ///< nothing: there are no error terms
    PositionLoss nominal;             ///< error of the uncalibrated robot
    bool has_workspace = false;       ///< whether the user stated where the robot works
    bool is_nearest = false;          ///< whether `nearest` is written
    std::optional<CalibratedUrdf> urdf;
    std::vector<DhRow> dh;           ///< empty: not asked for
    std::optional<UrFrames> frames;  ///< for a UR
    std::optional<ModifiedDh> robodk = {};
    std::vector<ReadBack> read_back;
    std::optional<CorrectionMap> map = {};    ///< corrects the terms; nothing: not asked for
    std::optional<CameraPlaces> camera = {};  ///< nothing: not asked for

    const Geometry& written() const { return is_nearest ? *nearest : estimated; }
};
std::string to_json(const ExportedRobot& robot, const Campaign& campaign);

// Results as one self-contained HTML file; designs/page.md explains its contents.

/// Configurations to draw, as measured.
struct PageConfigurations {
    std::vector<std::string> ids;
    RowMatrixXd joints;  ///< ids x joints (and measured torques), rad or m
};

/// A camera's image, to draw corners in.
struct PageImage {
    std::optional<ImageCoverage> coverage;  ///< nothing: the image's size is not stated
    double rms = 0;                         ///< lengths of the corners' residuals, px
    std::string name{};                     ///< CameraImage::name
};

/// Where a reading is in which of the images.
struct PageCorner {
    Index image = 0;
    std::array<double, 2> place{};  ///< px
};

/// Residuals of the measurements that a calibration was made with.
struct PageResiduals {
    std::vector<std::string> axes;          ///< residual_axes()
    std::vector<const AmountUnits*> units;  ///< of each axis
    std::vector<std::string> names;         ///< reading_names()
    Measurements measurements;
    std::vector<ReadingResidual> readings;
    std::vector<PageImage> images{};    ///< one a camera; empty: no camera
    std::vector<PageCorner> corners{};  ///< one a reading, if there are images
    /// Those of cameras beside sensors that measure otherwise, if there are any.
    std::vector<PageResiduals> of_cameras{};
    /// "validation", "verification", "left_out": residuals of poses it was judged at.
    std::vector<std::pair<std::string, PageResiduals>> judged{};
    bool has_own_set_up = false;  ///< base or targets are others than those of the page's scene
};
/// Adds the words of the campaign's sensor.
PageResiduals page_residuals(const Campaign& campaign, const Measurements& measurements,
                             std::vector<ReadingResidual> readings);

/// Where a plan's poses are expected to show corners, without residuals; nothing: no camera.
std::optional<PageResiduals> page_expected(const Campaign& campaign, const Plan& plan);

/// One plan, estimate or study.
struct PagePart {
    std::string title;
    std::optional<std::string> command{};  ///< the command that made it
    std::string made_at;                   ///< UTC, ISO 8601
    std::optional<std::string> printed{};  ///< by that command, as text
    std::string document;                  ///< as to_json() gives it
    std::optional<Scene> scene{};
    std::optional<VectorXd> first_pose{};  ///< for a plan: where its scene is checked
    PageConfigurations configurations{};   ///< measured ones
    std::optional<PageResiduals> residuals{};
    std::optional<PageResiduals> expected{};  ///< page_expected(); plans only
    std::optional<ErrorMap> error_map{};
};

/// The document of a page. Throws InputError if a part's document is not valid, or if a name in it
/// is not UTF-8.
std::string to_json(const std::vector<PagePart>& parts);

/// The HTML page, parts side by side. Throws InputError as to_json().
std::string to_page(const std::vector<PagePart>& parts);

/// Writes the page, all or nothing, with the warnings given while it was made. Throws InputError as
/// to_page(), and if it cannot be written.
void write_page(const std::string& path, const std::vector<PagePart>& parts,
                const std::vector<std::string>& warnings = {});

}  // namespace posewise::io
