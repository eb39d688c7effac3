#include "judgement_json.hpp"

#include <map>

#include "task/calibration/judgement.hpp"

namespace posewise::detail {
namespace {

constexpr double mm = 1e3;

const std::map<PoseGroup, const char*> groups{
    {PoseGroup::New, "new"}, {PoseGroup::Beyond, "beyond"}, {PoseGroup::Repeated, "repeated"}};
const std::map<ChanceVerdict, const char*> chances{{ChanceVerdict::Within, "within chance"},
                                                   {ChanceVerdict::Below, "below chance"},
                                                   {ChanceVerdict::Beyond, "beyond chance"}};

Json group_to_json(const Calibration& calibration, const char* poses, const JudgedGroup& group,
                   const std::string& unit) {
    const auto& interval = group.interval;
    Json json = {
        {"poses", poses},
        {"group", groups.at(group.group)},
        {"configuration_count", group.configurations.size()},
        {"joints", group.joints},
        {"rms" + unit, mm * group.found.rms()},
        {"lower" + unit, interval ? Json(mm * interval->lower) : Json(nullptr)},
        {"upper" + unit, interval ? Json(mm * interval->upper) : Json(nullptr)},
        {"degrees_of_freedom", interval ? Json(interval->degrees_of_freedom) : Json(nullptr)}};
    if (group.expected) {
        json["expected" + unit] = mm * group.expected->total();
        json["chance"] = group.chance;
    }
    const bool is_judged = group.verdict != ChanceVerdict::NotJudged;
    json["verdict"] = is_judged ? Json(chances.at(group.verdict)) : Json(nullptr);
    if (group.nominal) json["nominal" + unit] = mm * *group.nominal;
    if (group.worst) {
        json["worst"] = group.worst->id;
        json["rms_without_worst" + unit] = mm * group.worst->without;
    }
    if (!calibration.limit) return json;
    const auto verdict = judge_limit(group, *calibration.limit);
    json["limit"] = verdict ? Json(name_of(limit_verdicts, *verdict)) : Json(nullptr);
    if (verdict == LimitVerdict::Open) {
        const auto count = poses_to_decide(group, *calibration.limit);
        json["poses_to_decide"] = count ? Json(*count) : Json(nullptr);
    }
    return json;
}

}  // namespace

Json metrics_to_json(const Metrics& metrics) {
    const auto millimetres = [](const std::array<double, 3>& xyz) {
        return Json{{"x", mm * xyz[0]}, {"y", mm * xyz[1]}, {"z", mm * xyz[2]}};
    };
    Json json = {{"point_count", metrics.point_count}};
    if (metrics.coordinate_count > 0) {
        json["distance_rms_mm"] = mm * metrics.distance_rms;
        json["distance_max_mm"] = mm * metrics.distance_max;
        json["distance_mean_mm"] = mm * metrics.distance_mean;
        json["distance_p95_mm"] = mm * metrics.distance_p95;
    }
    if (metrics.coordinate_count == 3) {
        json["coordinate_rms_mm"] = millimetres(metrics.coordinate_rms);
        json["coordinate_max_mm"] = millimetres(metrics.coordinate_max);
    }
    if (metrics.has_orientation) {
        const std::string what =
            metrics.orientation_units == &pixel_units ? "reprojection" : "orientation";
        const std::string unit = error_suffix(*metrics.orientation_units);
        json[what + "_rms" + unit] = 1e3 * metrics.orientation_rms;
        json[what + "_max" + unit] = 1e3 * metrics.orientation_max;
    }
    return json;
}

Json images_to_json(const std::vector<ImageCoverage>& images) {
    Json list = Json::array();
    for (const ImageCoverage& image : images) {
        Json& one = list.emplace_back(Json{{"camera", image.camera + 1},
                                           {"size_px", image.size},
                                           {"covered", image.part},
                                           {"empty", image.empty}});
        if (image.sensor) one["sensor"] = *image.sensor + 1;
    }
    return list;
}

void add_judgements(Json& accuracy, const Calibration& calibration) {
    Json judged = Json::array();
    const auto add = [&](const std::optional<Judgement>& judgement, const char* poses) {
        if (!judgement) return;
        accuracy[poses] = metrics_to_json(judgement->found);
        for (const JudgedGroup& group : judgement->groups) {
            judged.push_back(
                group_to_json(calibration, poses, group, error_suffix(*judgement->units)));
        }
    };
    add(calibration.verification, "verification");
    add(calibration.left_out, "left_out");
    add(calibration.validation, "validation");
    if (judged.empty()) return;
    accuracy["judged"] = std::move(judged);
    if (calibration.limit) accuracy["limit_mm"] = mm * *calibration.limit;
}

}  // namespace posewise::detail
