#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include "core/text.hpp"
#include "io/format/csv_reader.hpp"
#include "io/measurements/measurement_columns.hpp"
#include "program_text.hpp"

namespace posewise::io {
namespace {

/// What is at most a rounding of half_step a step: the least digits of decimal numbers are lost.
constexpr double half_step = 0.5 + 1e-6;

bool is_same(const VectorXd& a, const VectorXd& b, const VectorXd& steps) {
    return ((a - b).cwiseAbs().array() <= half_step * steps.array()).all();
}

/// A pose of the plan and what it is for.
struct Expected {
    const PlannedPose* pose = nullptr;
    std::string_view purpose;
    VectorXd joints;  ///< of the controller
};

/// By their labels in small letters, which tell them apart, whatever a pendant makes of them.
std::map<std::string, Expected> expected_of(const std::optional<Plan>& sent,
                                            const ControllerJoints& joints) {
    std::map<std::string, Expected> expected;
    if (!sent) return expected;
    std::vector<Expected> all;
    std::vector<std::string> ids;
    const auto add = [&](const std::vector<PlannedPose>& poses, std::string_view purpose) {
        for (const PlannedPose& pose : poses) {
            all.push_back(
                {&pose, purpose, joints.to_controller(pose.configuration.head(joints.count()))});
            ids.push_back(pose.id);
        }
    };
    add(sent->poses, detail::to_calibrate);
    add(sent->verification, detail::to_verify);
    const std::vector<std::string> labels = pose_labels(ids);
    for (std::size_t k = 0; k < all.size(); ++k) expected[detail::lower_case(labels[k])] = all[k];
    return expected;
}

/// The content as it grows, stop by stop.
class ContentReader {
  public:
    ContentReader(std::string path, const CampaignFile& campaign, const VectorXd& steps,
                  const std::optional<Plan>& sent)
        : path_(std::move(path)),
          campaign_(campaign),
          joints_(campaign.controller),
          steps_(steps),
          sent_(sent),
          expected_(expected_of(sent, joints_)) {}

    void take(const ProgramStop& stop) {
        ++stop_count_;
        using Kind = RouteStop::Kind;
        if (stop.label == "home") {
            passed_.clear();
            return add_stop(Kind::Home, "home", stop);
        }
        const std::string id = id_of(stop);
        if (id.empty()) {
            passed_.push_back(stop.joints);
            return add_stop(Kind::Via, "", stop);
        }
        add_stop(Kind::Pose, id, stop);
        ++visits_[id];
        const auto [first, is_new] = joints_of_.emplace(id, stop.joints);
        if (is_new) {
            add_pose(id, stop);
        } else if (!is_same(stop.joints, first->second, steps_)) {
            throw input_error_at(
                stop.place.path.empty() ? FileLocation{path_} : stop.place,
                fmt::format("visits {} at other joints than before; must be at the same, or have "
                            "another name",
                            detail::quote(stop.label.empty() ? id : stop.label)));
        }
        passed_.clear();
    }

    ProgramContent content() {
        content_.joints.resize(std::ssize(rows_), joints_.count());
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            content_.joints.row(static_cast<Index>(k)) = joints_.to_model(rows_[k]).transpose();
        }
        find_dropped();
        count_visits();
        try {
            content_.faults = find_faults(route_, campaign_, sent_);
        } catch (const InputError& problem) {
            throw input_error_at({campaign_.path}, problem.what());
        }
        return content_;
    }

  private:
    void add_stop(RouteStop::Kind kind, const std::string& id, const ProgramStop& stop) {
        route_.push_back({kind, id, 1, joints_.to_model(stop.joints)});
    }

    /// Of the pose that the stop is; empty: it is a via.
    std::string id_of(const ProgramStop& stop) {
        if (!stop.label.empty()) {
            if (!stop.is_measured) return "";
            const auto found = expected_.find(detail::lower_case(stop.label));
            return found == expected_.end() ? stop.label : found->second.pose->id;
        }
        if (const PlannedPose* const pose = pose_at(stop.joints)) {
            note(pose->id, content_.recognised);
            return pose->id;
        }
        if (!stop.is_measured) return "";
        std::string id = fmt::format("stop{}", stop_count_);
        while (joints_of_.contains(id) || expected_.contains(id)) id += '_';
        note(id, content_.unnamed);
        return id;
    }

    /// The plan's pose at these joints; nullptr: there is none.
    const PlannedPose* pose_at(const VectorXd& joints) const {
        const auto found = std::ranges::find_if(
            expected_, [&](const auto& one) { return is_same(joints, one.second.joints, steps_); });
        return found == expected_.end() ? nullptr : found->second.pose;
    }

    static void note(const std::string& id, std::vector<std::string>& ids) {
        if (std::ranges::find(ids, id) == ids.end()) ids.push_back(id);
    }

    void add_row(const std::string& id, const VectorXd& joints, std::string_view purpose) {
        content_.ids.push_back(id);
        content_.purposes.emplace_back(purpose);
        rows_.push_back(joints);
    }

    void add_pose(const std::string& id, const ProgramStop& stop) {
        const auto found = std::ranges::find_if(
            expected_, [&](const auto& one) { return one.second.pose->id == id; });
        const bool is_known = found != expected_.end();
        for (std::size_t k = 0; k < passed_.size(); ++k) {
            add_row(fmt::format("{}.via{}", id, k == 0 ? "" : std::to_string(k + 1)), passed_[k],
                    detail::on_the_way);
        }
        add_row(id, stop.joints, is_known ? found->second.purpose : detail::to_calibrate);
        if (!sent_) return;
        if (is_known) return find_moved(id, stop.joints - found->second.joints);
        if (stop.label.empty()) return;
        const PlannedPose* const pose = pose_at(stop.joints);
        if (pose == nullptr) return content_.added.push_back(id);
        content_.again.emplace_back(id, pose->id);
    }

    void find_moved(const std::string& id, const VectorXd& change) {
        if (is_same(change, VectorXd::Zero(change.size()), steps_)) return;
        Index joint = 0;
        change.cwiseAbs().maxCoeff(&joint);
        content_.moved.push_back({id, joint, change[joint]});
    }

    /// Poses that are not visited, by no other name either.
    void find_dropped() {
        if (!sent_) return;
        const auto is_visited = [&](const std::string& id) {
            return visits_.contains(id) ||
                   std::ranges::any_of(content_.again,
                                       [&](const auto& one) { return one.second == id; });
        };
        for (const auto* poses : {&sent_->poses, &sent_->verification}) {
            for (const PlannedPose& pose : *poses) {
                if (!is_visited(pose.id)) content_.dropped.push_back(pose.id);
            }
        }
    }

    void count_visits() {
        std::map<Index, Index> poses;  // that are visited so often
        for (const auto& [id, count] : visits_) ++poses[count];
        Index most = 0;
        for (const auto& [count, number] : poses) {
            if (number <= most) continue;
            most = number;
            content_.visits = count;
        }
        for (const std::string& id : content_.ids) {
            const auto found = visits_.find(id);
            if (found == visits_.end() || found->second == content_.visits) continue;
            content_.other_visits.emplace_back(id, found->second);
        }
    }

    std::string path_;
    const CampaignFile& campaign_;
    const ControllerJoints& joints_;
    const VectorXd& steps_;
    const std::optional<Plan>& sent_;
    std::map<std::string, Expected> expected_;
    std::map<std::string, VectorXd> joints_of_;  // the first visit's
    std::map<std::string, Index> visits_;
    std::vector<VectorXd> passed_;
    std::vector<VectorXd> rows_;
    std::vector<RouteStop> route_;
    Index stop_count_ = 0;
    ProgramContent content_;
};

}  // namespace

ProgramContent program_content(const std::string& path, const std::vector<ProgramStop>& stops,
                               const CampaignFile& campaign, const VectorXd& steps,
                               const std::optional<Plan>& sent) {
    ContentReader reader(path, campaign, steps, sent);
    for (const ProgramStop& stop : stops) reader.take(stop);
    return reader.content();
}

void write_program_content(const std::string& path, const Campaign& campaign,
                           const ProgramContent& content) {
    std::string text =
        fmt::format("config{},{}\n", detail::joint_header(campaign), detail::purpose_column);
    for (std::size_t k = 0; k < content.ids.size(); ++k) {
        const VectorXd q = content.joints.row(static_cast<Index>(k)).transpose();
        fmt::format_to(std::back_inserter(text), "{}{},{}\n", detail::csv_field(content.ids[k]),
                       detail::joint_cells(campaign, q), content.purposes[k]);
    }
    detail::write_file(path, text);
}

}  // namespace posewise::io
