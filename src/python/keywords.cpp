#include "keywords.hpp"

#include "calibrator/loss.hpp"
#include "core/effort.hpp"
#include "io/format/fields.hpp"
#include "planner/focus_names.hpp"
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
constexpr Index most_drawn = 10000000;
constexpr double degree = to_radians(1);
constexpr double millimetre = 1e-3;

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

void set_earlier(const Stated& stated, EarlierUse& use) {
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

void read_effort(const Stated& stated, Index& starts, std::optional<double>* proof = nullptr) {
    detail::Effort effort = detail::Effort::Usual;
    stated("effort", effort, OneOf(detail::effort_names));
    detail::set_effort(effort, starts, proof);
}

void read_prior(const Stated& stated, std::optional<bool>& prior) {
    if (stated.has("prior")) stated("prior", prior.emplace());
}

/// What select and plan have in common.
PlanCall read_call(const Stated& stated) {
    PlanCall call;
    PlanRequest& request = call.request;
    stated("poses", request.pose_count, Count{1, most_poses});
    read_criterion(stated, request.criterion);
    read_prior(stated, call.prior);
    request.has_prior = call.prior.value_or(false);
    stated("force", call.is_forced);
    stated("held", request.sources.augment);
    stated("estimate", request.sources.estimate);
    stated("focus", request.focus, OneOf(detail::focus_names));
    stated("repeats", request.repeats, Number{.least = 1, .most = 1e9});
    stated("starts", request.starts, Count{0, 1000000});
    stated("seed", request.seed);
    set_earlier(stated, request.earlier);
    return call;
}

}  // namespace

Keywords parse_keywords(const std::string& function, const std::string& json) {
    return {function, detail::Json::parse(json)};
}

PlanCall choice_call(const Keywords& keywords) {
    const Stated stated(keywords);
    PlanCall call = read_call(stated);
    PlanRequest& request = call.request;
    read_effort(stated, request.starts, &request.proof);
    stated("candidates", request.sources.candidates);
    stated("measurements", request.sources.candidates);
    stated("random", call.random_count, Count{1, most_drawn});
    if (stated.has("measurements")) call.kind = CandidateKind::Measurements;
    if (stated.has("random")) call.kind = CandidateKind::Random;
    stated("test_poses", request.sources.test_poses);
    stated("groups", call.groups, Count{0, most_drawn});
    stated("per_group", request.group_limit, Count{1, most_poses});
    stated("exclude", request.excluded);
    stated("repeat_limit", request.repeat_limit, Count{1, most_poses});
    stated.in(degree, "least_distance_deg", request.least_distance, Number{.least = 0});
    stated("proof", request.proof, Number{.least = 0, .most = 1e9});
    return call;
}

PlanCall planning_call(const Keywords& keywords) {
    const Stated stated(keywords);
    PlanCall call = read_call(stated);
    PlanRequest& request = call.request;
    read_effort(stated, request.starts);
    if (!stated.has("repeats")) request.repeats = 1;
    stated("repair", request.sources.repaired);
    stated("drop", request.dropped);
    stated("workspace", request.sources.workspace);
    stated("workspace_poses", request.workspace_count, Count{1, 20000});
    stated("workspace_box_mm", request.workspace_box_mm);
    stated("workspace_target", request.workspace_target, Count{0, 10000});
    stated("pool", request.pool_count, Count{1, most_drawn});
    stated("verification", request.verification_count, Count{0, 10000});
    stated("random_order", request.random_order, Number{.least = 1, .most = 1e6});
    return call;
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

CalibrationCall calibration_call(const Keywords& keywords) {
    const Stated stated(keywords);
    CalibrationCall call;
    CalibrationOptions& options = call.options;
    stated("measurements", call.measurements);
    stated("plan", call.plans);
    stated("points_unit", call.points_unit);
    stated("validate", call.validation);
    stated("estimate", call.estimate);
    stated("force", call.is_forced);
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
    read_prior(stated, call.prior);
    if (stated.has("sizes")) stated("sizes", call.learns_sizes.emplace(), OneOf(sizes));
    stated("free", call.free);
    set_earlier(stated, call.earlier);
    return call;
}

StudyCall study_call(const Keywords& keywords) {
    const Stated stated(keywords);
    StudyCall call;
    SimulatedStudyOptions& options = call.options;
    if (stated.has("criteria")) stated("criteria", options.criteria.emplace());
    stated("poses", options.pose_counts, Count{1, most_poses});
    stated("measurements", call.measurements);
    if (!call.measurements.empty()) options.random_subsets = StudyOptions().random_subsets;
    stated("random", options.random_subsets, Count{0, most_poses});
    stated.in(degree, "least_distance_deg", options.least_distance, Number{.least = 0});
    read_effort(stated, options.starts);
    stated("starts", options.starts, Count{1, 1000000});
    stated("seed", options.seed);
    stated("exclude", call.excluded);
    read_prior(stated, call.prior);
    stated("force", call.is_forced);
    if (stated.has("splits")) stated("splits", options.splits.emplace(), Count{0, most_poses});
    if (stated.has("holdout")) {
        stated("holdout", options.holdout.emplace(), Number{.above = 0, .most = 0.9});
    }
    stated("trials", options.trials, Count{1, 100000000});
    stated("precision", options.precision, Number{.least = 0, .most = 1});
    stated("pool", options.pool_count, Count{1, most_drawn});
    stated("test_poses", options.test_count, Count{1, most_poses});
    stated("repeats", options.repeats, Count{1, most_poses});
    stated("refine", options.is_refined);
    return call;
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
    read_effort(stated, options.starts, &options.proof);
    stated("starts", options.starts, Count{0, 1000000});
    stated("proof", options.proof, Number{.least = 0, .most = 1e9});
    stated("seed", options.seed);
    return options;
}

}  // namespace posewise::python
