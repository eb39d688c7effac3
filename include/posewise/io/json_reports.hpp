#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/io/estimate_file.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/io/urdf_file.hpp"
#include "posewise/measurement/simulation.hpp"
#include "posewise/model/dh.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/geometry.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/readings.hpp"
#include "posewise/task/simulated_plan.hpp"
#include "posewise/task/study.hpp"
#include "posewise/task/target.hpp"
#include "posewise/task/verification.hpp"

/// What tasks found, as one JSON document for other programs each: what the program prints with
/// --json. designs/json.md explains every key. Units stand in the keys, numbers have as many digits
/// as it takes to read them back exactly, and what is infinite or unknown is null. All throw
/// InputError if a name or id is not UTF-8.
namespace posewise::io {

/// A document with these sentences as its `warnings`, in place of those it has. Throws InputError
/// if it is no JSON object.
std::string with_warnings(const std::string& document, const std::vector<std::string>& warnings);

std::string to_json(const Inspection& inspection);

/// With the readings of measurements that were tried, the best fitting first.
std::string to_json(const Inspection& inspection, const ReadingSearch& readings);

std::string to_json(const Rating& rating, const Campaign& campaign);

/// The plan as its file `path` has it, that file, and what is predicted.
std::string to_json(const Plan& plan, const std::string& path);
/// Likewise, with what became of the planning, the accuracy of other numbers of poses, and how it
/// was verified, if it was.
std::string to_json(const Planning& planning, const std::vector<CountAccuracy>& counts,
                    const std::string& path,
                    const std::optional<SimulatedPlan>& simulated = std::nullopt);

/// Likewise of a plan that keeps a target, with what other numbers of poses reach.
std::string to_json(const TargetPlanning& found, const std::string& path,
                    const std::optional<SimulatedPlan>& simulated = std::nullopt);

std::string to_json(const ApproximateDesign& design);

/// Of the plan in the file `path`.
std::string to_json(const Verification& verification, const Plan& plan, const std::string& path);

/// As write_estimate() writes it. The calibration must be identified.
std::string to_json(const Calibration& calibration, const Provenance& made_from);

/// Of one error model, or of several (compare_models()).
std::string to_json(const std::vector<Study>& studies);

std::string to_json(const Simulation& simulation, const Campaign& campaign);

std::string to_json(const CorrectedPoses& poses, const Campaign& campaign);

/// A file that was written, as it was read back.
struct ReadBack {
    std::string path;
    FlangeDifference difference;
};

/// A calibrated robot in forms that others read.
struct ExportedRobot {
    /// Error terms that are not zero, which none of the forms can have.
    std::vector<std::string> terms;
    Geometry estimated;               ///< without them
    std::optional<Geometry> nearest;  ///< nothing: there are none
    PositionLoss nominal;             ///< what the robot misses that is not calibrated
    bool has_workspace = false;       ///< where the robot works was said
    bool is_nearest = false;          ///< that one is written
    std::optional<CalibratedUrdf> urdf;
    std::vector<DhRow> dh;           ///< empty: not asked for
    std::optional<UrFrames> frames;  ///< of a UR
    std::vector<ReadBack> read_back;

    const Geometry& written() const { return is_nearest ? *nearest : estimated; }
};
std::string to_json(const ExportedRobot& robot, const Campaign& campaign);

}  // namespace posewise::io
