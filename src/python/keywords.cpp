#include "keywords.hpp"

#include "calibrator/loss.hpp"
#include "io/format/fields.hpp"
#include "posewise/core/types.hpp"
#include "task/calibration/calibration_options.hpp"

namespace posewise::python {
namespace {

using detail::Count;
using detail::Fields;
using detail::JsonValue;
using detail::Names;
using detail::Number;
using detail::OneOf;

constexpr Index most_poses = 1000000;
constexpr double degree = to_radians(1);
constexpr double millimetre = 1e-3;

constexpr Names<bool, 2> foci{{{false, "all"}, {true, "robot"}}};
constexpr Names<bool, 2> sizes{{{false, "stated"}, {true, "learned"}}};
constexpr Names<ErrorQuantity, 3> quantities{{{ErrorQuantity::Rms, "rms"},
                                              {ErrorQuantity::Percentile95, "p95"},
                                              {ErrorQuantity::Max, "max"}}};

/// Keywords that may be left out.
class Stated {
  public:
    explicit Stated(const Keywords& keywords) : fields_(root(keywords)) {}

    template <typename T, typename Form = detail::AnyValue>
    void operator()(const char* key, T& value, const Form& form = {}) const {
        fields_.optional(key, false, value, form);
    }
    /// A number in `unit` SI units.
    void in(double unit, const char* key, double& value, const Number& form) const {
        if (!fields_.has(key, false)) return;
        fields_(key, value, form);
        value *= unit;
    }
    bool has(const char* key) const { return fields_.has(key, false); }
    void check(const char* key, bool holds, const std::string& rule) const {
        if (has(key)) fields_.check(key, holds, rule);
    }

  private:
    static JsonValue root(const Keywords& keywords) {
        return {keywords.stated, keywords.function + "()"};
    }
    Fields fields_;
};

/// A criterion, or nothing.
void read_criterion(const Stated& stated, CriterionChoice& criterion) {
    Criterion named{};
    if (!stated.has("criterion")) return;
    stated("criterion", named);
    criterion = named;
}

void read_earlier(const Stated& stated, EarlierUse& use) {
    std::vector<std::string> moved;
    stated("as_prior", use.is_prior);
    stated("only", use.only);
    stated("moved", moved);
    for (const std::string& part : moved) {
        stated.check("moved", part == "base" || part == "targets", "must be base, targets or both");
        (part == "base" ? use.has_new_base : use.has_new_targets) = true;
    }
    const Number drift{.above = 0, .most = 1e3};
    stated.in(millimetre, "drift_mm", use.drift.length, drift);
    stated.in(1e-3, "drift_offset_mrad", use.drift.offset, drift);
    stated.in(1e-3, "drift_mrad", use.drift.angle, drift);
}

/// What select and plan have in common.
PlanRequest read_request(const Stated& stated) {
    PlanRequest request;
    stated("poses", request.pose_count, Count{1, most_poses});
    read_criterion(stated, request.criterion);
    stated("prior", request.has_prior);
    stated("focus", request.is_focused_on_robot, OneOf(foci));
    stated("repeats", request.repeats, Number{.least = 1, .most = 1e9});
    stated("starts", request.starts, Count{0, 1000000});
    stated("seed", request.seed);
    read_earlier(stated, request.earlier);
    return request;
}

void read_study(const Stated& stated, StudyOptions& options) {
    if (stated.has("criteria")) stated("criteria", options.criteria.emplace());
    stated("poses", options.pose_counts, Count{1, most_poses});
    stated("random", options.random_subsets, Count{0, most_poses});
    stated.in(degree, "least_distance_deg", options.least_distance, Number{.least = 0});
    stated("starts", options.starts, Count{1, 1000000});
    stated("seed", options.seed);
}

}  // namespace

Keywords parse_keywords(const std::string& function, const std::string& json) {
    return {function, detail::Json::parse(json)};
}

PlanRequest choice_request(const Keywords& keywords) {
    const Stated stated(keywords);
    PlanRequest request = read_request(stated);
    stated("per_group", request.group_limit, Count{1, most_poses});
    stated("exclude", request.excluded);
    stated("repeat_limit", request.repeat_limit, Count{1, most_poses});
    stated.in(degree, "least_distance_deg", request.least_distance, Number{.least = 0});
    stated("proof", request.proof, Number{.least = 0, .most = 1e9});
    return request;
}

PlanRequest planning_request(const Keywords& keywords) {
    const Stated stated(keywords);
    PlanRequest request = read_request(stated);
    if (!stated.has("repeats")) request.repeats = 1;
    stated("drop", request.dropped);
    stated("workspace_poses", request.workspace_count, Count{1, 20000});
    stated("workspace_box_mm", request.workspace_box_mm);
    stated("workspace_target", request.workspace_target, Count{0, 10000});
    stated("pool", request.pool_count, Count{1, 10000000});
    stated("verification", request.verification_count, Count{0, 10000});
    stated("random_order", request.random_order, Number{.least = 1, .most = 1e6});
    return request;
}

std::optional<TargetOptions> target_options(const Keywords& keywords) {
    const Stated stated(keywords);
    if (!stated.has("target_mm") && !stated.has("minutes")) return std::nullopt;
    TargetOptions target;
    if (stated.has("target_mm")) {
        stated.in(millimetre, "target_mm", target.limit.emplace(),
                  Number{.least = 1e-6, .most = 1e6});
    }
    if (stated.has("minutes")) {
        stated.in(60, "minutes", target.duration.emplace(), Number{.least = 1e-6, .most = 1e6});
    }
    stated("assurance", target.assurance, Number{.least = 0.01, .most = 0.999});
    stated("quantity", target.quantity, OneOf(quantities));
    stated("poses_at_most", target.most_poses, Count{1, 10000});
    stated("robust_to", target.robust_to, Count{0, 1000});
    return target;
}

CalibrationRequest calibration_request(const Keywords& keywords) {
    const Stated stated(keywords);
    CalibrationRequest request;
    CalibrationOptions& options = request.options;
    stated("method", options.method, OneOf(detail::method_names));
    stated("loss", options.joint.loss.kind, OneOf(detail::loss_names));
    stated("loss_width", options.joint.loss.width, Number{.above = 0, .most = 1e6});
    if (stated.has("folds")) stated("folds", options.folds.emplace(), Count{0, most_poses});
    stated("model_selection", options.model_selection);
    stated("refit", options.refitted);
    if (stated.has("limit_mm")) {
        stated.in(millimetre, "limit_mm", options.limit.emplace(), Number{.above = 0, .most = 1e6});
    }
    stated("exclude", options.excluded);
    stated("prior", request.prior);
    if (stated.has("sizes")) stated("sizes", request.learns_sizes.emplace(), OneOf(sizes));
    stated("free", request.free);
    read_earlier(stated, request.earlier);
    return request;
}

StudyOptions study_options(const Keywords& keywords) {
    const Stated stated(keywords);
    StudyOptions options;
    read_study(stated, options);
    if (stated.has("splits")) stated("splits", options.splits.emplace(), Count{0, most_poses});
    stated("holdout", options.holdout, Number{.above = 0, .most = 0.9});
    return options;
}

SimulatedStudyOptions simulated_study_options(const Keywords& keywords) {
    const Stated stated(keywords);
    SimulatedStudyOptions options;
    read_study(stated, options);
    stated("trials", options.trials, Count{1, 100000000});
    stated("precision", options.precision, Number{.least = 0, .most = 1});
    stated("pool", options.pool_count, Count{1, 10000000});
    stated("test_poses", options.test_count, Count{1, most_poses});
    stated("repeats", options.repeats, Count{1, most_poses});
    stated("refine", options.is_refined);
    return options;
}

BlocksStudyOptions blocks_study_options(const Keywords& keywords) {
    const Stated stated(keywords);
    BlocksStudyOptions options;
    stated("criteria", options.criteria);
    stated("poses", options.pose_counts, Count{1, most_poses});
    stated("random", options.random_subsets, Count{0, most_poses});
    stated("prior", options.has_prior);
    stated("exclude", options.excluded);
    stated("repeat_limit", options.repeat_limit, Count{1, most_poses});
    stated("starts", options.starts, Count{0, 1000000});
    stated("proof", options.proof, Number{.least = 0, .most = 1e9});
    stated("seed", options.seed);
    return options;
}

}  // namespace posewise::python
