#include "io/format/json.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "posewise/io/robot_programs.hpp"

namespace posewise::io {

using detail::Json;

std::string to_json(const ProgramReport& report, const Campaign& campaign) {
    Json document = detail::make_document("program");
    document["campaign"] = campaign.name;
    document["for"] = program_format_name(report.format);
    document["files"] = report.files;
    document["as_sent"] = report.sent;
    document["moves"] = report.stop_count;
    document["measured"] = report.visit_count;
    if (!report.by_hand.empty()) document["by_hand"] = report.by_hand;
    document["stale"] = report.stale;
    if (report.loss) {
        const RoundingLoss& loss = *report.loss;
        Json& rounding = document["rounding"];
        rounding["largest_deg"] = to_degrees(loss.largest_turn);
        rounding["largest_mm"] = mm_per_m * loss.largest_slide;
        rounding["criterion"] = criterion_name(loss.criterion);
        rounding["planned"]["value"] = loss.planned;
        rounding["sent"]["value"] = loss.sent;
        rounding["planned"]["position_error_rms_mm"] = detail::millimetres(loss.planned_rms);
        rounding["sent"]["position_error_rms_mm"] = detail::millimetres(loss.sent_rms);
    }
    return detail::json_text(document);
}

std::string to_json(const ProgramContent& content, const CampaignFile& campaign) {
    Json document = detail::make_document("program read");
    document["campaign"] = campaign.name;
    Json& list = document["configurations"] = Json::array();
    const std::vector<std::string> columns = detail::reading_columns(campaign);
    for (std::size_t i = 0; i < content.ids.size(); ++i) {
        Json one = {{"id", content.ids[i]}, {"purpose", content.purposes[i]}};
        for (Index j = 0; j < content.joints.cols(); ++j) {
            one["joints"][columns[static_cast<std::size_t>(j)]] =
                detail::for_people(campaign, j, content.joints(static_cast<Index>(i), j));
        }
        list.push_back(one);
    }
    document["dropped"] = content.dropped;
    Json& moved = document["moved"] = Json::array();
    for (const MovedPose& pose : content.moved) {
        const bool turns = campaign.controller.motion(pose.joint) == Motion::Rotation;
        moved.push_back(
            {{"id", pose.id},
             {"joint", campaign.controller.names()[static_cast<std::size_t>(pose.joint)]},
             {turns ? "by_deg" : "by_mm",
              turns ? to_degrees(pose.change) : mm_per_m * pose.change}});
    }
    document["added"] = content.added;
    Json& again = document["again"] = Json::array();
    for (const auto& [id, pose] : content.again) again.push_back({{"id", id}, {"at", pose}});
    document["recognised"] = content.recognised;
    document["unnamed"] = content.unnamed;
    document["visits"] = content.visits;
    Json& others = document["other_visits"] = Json::array();
    for (const auto& [id, count] : content.other_visits) {
        others.push_back({{"id", id}, {"visits", count}});
    }
    document["faults"] = content.faults;
    return detail::json_text(document);
}

}  // namespace posewise::io
