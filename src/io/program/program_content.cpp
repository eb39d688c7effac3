#include <fmt/format.h>

#include <iterator>
#include <map>
#include <set>

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

/// Poses of the plan by their labels, with what they are for.
struct Expected {
    std::string id;
    const PlannedPose* pose = nullptr;
    std::string_view purpose;
};

std::map<std::string, Expected> expected_of(const std::optional<Plan>& sent) {
    std::map<std::string, Expected> expected;
    if (!sent) return expected;
    std::vector<Expected> all;
    std::vector<std::string> ids;
    const auto add = [&](const std::vector<PlannedPose>& poses, std::string_view purpose) {
        for (const PlannedPose& pose : poses) {
            all.push_back({pose.id, &pose, purpose});
            ids.push_back(pose.id);
        }
    };
    add(sent->poses, detail::to_calibrate);
    add(sent->verification, detail::to_verify);
    const std::vector<std::string> labels = pose_labels(ids);
    for (std::size_t k = 0; k < all.size(); ++k) expected[labels[k]] = all[k];
    return expected;
}

/// The content as it grows, stop by stop.
class ContentReader {
  public:
    ContentReader(std::string path, const ControllerJoints& joints, const VectorXd& steps,
                  const std::optional<Plan>& sent)
        : path_(std::move(path)),
          joints_(joints),
          steps_(steps),
          expected_(expected_of(sent)),
          has_plan_(sent.has_value()) {}

    void take(const ProgramStop& stop) {
        if (stop.label == "home") return passed_.clear();
        if (!stop.is_measured) return passed_.push_back(stop.joints);
        const auto [first, is_new] = visits_.emplace(stop.label, stop.joints);
        if (is_new) {
            add_pose(stop);
        } else if (!is_same(stop.joints, first->second, steps_)) {
            throw InputError(fmt::format(
                "{}: visits {} at other joints than before; must be at the same, or have another "
                "name",
                path_, detail::quote(stop.label)));
        }
        passed_.clear();
    }

    ProgramContent content(const std::optional<Plan>& sent) {
        content_.joints.resize(std::ssize(rows_), joints_.count());
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            content_.joints.row(static_cast<Index>(k)) = joints_.to_model(rows_[k]).transpose();
        }
        if (sent) find_dropped(*sent);
        return content_;
    }

  private:
    void add_row(const std::string& id, const VectorXd& joints, std::string_view purpose) {
        content_.ids.push_back(id);
        content_.purposes.emplace_back(purpose);
        rows_.push_back(joints);
    }

    void add_pose(const ProgramStop& stop) {
        const auto found = expected_.find(stop.label);
        const bool is_known = found != expected_.end();
        const std::string id = is_known ? found->second.id : stop.label;
        for (std::size_t k = 0; k < passed_.size(); ++k) {
            add_row(fmt::format("{}.via{}", id, k == 0 ? "" : std::to_string(k + 1)), passed_[k],
                    detail::on_the_way);
        }
        add_row(id, stop.joints, is_known ? found->second.purpose : detail::to_calibrate);
        if (!has_plan_) return;
        if (!is_known) return content_.added.push_back(id);
        visited_.insert(id);
        const VectorXd planned =
            joints_.to_controller(found->second.pose->configuration.head(joints_.count()));
        if (!is_same(stop.joints, planned, steps_)) content_.moved.push_back(id);
    }

    void find_dropped(const Plan& sent) {
        for (const auto* poses : {&sent.poses, &sent.verification}) {
            for (const PlannedPose& pose : *poses) {
                if (!visited_.contains(pose.id)) content_.dropped.push_back(pose.id);
            }
        }
    }

    std::string path_;
    const ControllerJoints& joints_;
    const VectorXd& steps_;
    std::map<std::string, Expected> expected_;
    bool has_plan_;
    std::map<std::string, VectorXd> visits_;
    std::set<std::string> visited_;
    std::vector<VectorXd> passed_;
    std::vector<VectorXd> rows_;
    ProgramContent content_;
};

}  // namespace

ProgramContent program_content(const std::string& path, const std::vector<ProgramStop>& stops,
                               const ControllerJoints& joints, const VectorXd& steps,
                               const std::optional<Plan>& sent) {
    ContentReader reader(path, joints, steps, sent);
    for (const ProgramStop& stop : stops) reader.take(stop);
    return reader.content(sent);
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
