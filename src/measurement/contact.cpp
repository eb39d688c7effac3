#include "contact.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {

std::optional<VectorXd> bring_to_contact(const Campaign& campaign, const Parameters& parameters,
                                         VectorXd q, Index contact, const JointRange& range,
                                         const VectorXd& readings) {
    constexpr int most_steps = 60;
    constexpr double touches = 1e-12;  // m
    constexpr double damping = 1e-6;   // of the largest a joint can do
    constexpr double longest = 0.5;    // rad or m: farther a step means nothing
    const Sensor& sensor = *campaign.sensor;
    const Index width = sensor.rows_per_target();
    const Index joints = campaign.robot.joint_count();
    RowMatrixXd J(sensor.row_count(), joints);
    FlangeMotion motion;
    for (int step = 0; step < most_steps; ++step) {
        campaign.robot.differentiate(parameters.world_from_base, q, parameters.robot, motion, true);
        const VectorXd miss = readings - sensor.predict(motion.world_from_flange, parameters.sensor)
                                             .segment(width * contact, width);
        if (miss.norm() <= touches) return q;
        sensor.differentiate(motion.world_from_flange, motion.joint_twists, parameters.sensor, J);
        MatrixXd rows = J.middleRows(width * contact, width);
        // Joints at a limit that the step would cross stay.
        for (Index tries = 0; tries < 2; ++tries) {
            MatrixXd M = rows * rows.transpose();
            M.diagonal().array() += damping * M.trace() + std::numeric_limits<double>::min();
            VectorXd d = rows.transpose() * M.llt().solve(miss);
            const double size = d.cwiseAbs().maxCoeff();
            if (!(size < std::numeric_limits<double>::infinity())) return std::nullopt;
            if (size > longest) d *= longest / size;
            const VectorXd moved = (q.head(joints) + d).cwiseMax(range.lower).cwiseMin(range.upper);
            const auto stays = ((moved - q.head(joints)).array() == 0 && d.array() != 0).eval();
            if (tries == 1 || !stays.any()) {
                q.head(joints) = moved;
                break;
            }
            for (Index j = 0; j < joints; ++j) {
                if (stays[j]) rows.col(j).setZero();
            }
        }
    }
    return std::nullopt;
}

namespace {

ShownPoses touch_in_turn(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& candidates, Index first, const JointRange& range) {
    const Sensor& sensor = *campaign.sensor;
    const Index targets = sensor.target_count();
    const VectorXd touching = VectorXd::Zero(sensor.rows_per_target());
    ShownPoses poses{RowMatrixXd(candidates.rows(), candidates.cols()),
                     Seen::Constant(candidates.rows(), targets, false)};
    Index count = 0;
    for (Index i = 0; i < candidates.rows(); ++i) {
        const Index contact = (first + i) % targets;
        const auto q = bring_to_contact(campaign, parameters, candidates.row(i).transpose(),
                                        contact, range, touching);
        if (!q) continue;
        poses.configurations.row(count) = q->transpose();
        poses.is_seen(count, contact) = true;
        ++count;
    }
    poses.configurations.conservativeResize(count, Eigen::NoChange);
    poses.is_seen.conservativeResize(count, Eigen::NoChange);
    return poses;
}

}  // namespace

ShownPoses bring_to_contacts(const Campaign& campaign, const Parameters& parameters,
                             const RowMatrixXd& candidates, Index first, const JointRange& range) {
    const Sensor& sensor = *campaign.sensor;
    if (sensor.has_contacts()) return touch_in_turn(campaign, parameters, candidates, first, range);
    return {candidates, all_seen(candidates.rows(), sensor.target_count())};
}

std::optional<ShownPoses> touching_poses(const Campaign& campaign, const Parameters& parameters,
                                         Index count, std::uint64_t seed) {
    const Sensor& sensor = *campaign.sensor;
    const bool is_stated = campaign.has_nominal_base && campaign.has_nominal_targets;
    if (!sensor.touches() || sensor.has_contacts() || !is_stated) return std::nullopt;
    constexpr Index drawn_for_one = 4;
    const Index drawn = drawn_for_one * std::max(count, sensor.target_count());
    ShownPoses poses =
        touch_in_turn(campaign, parameters, random_configurations(campaign.robot, drawn, seed), 0,
                      limits_of(campaign.robot));
    if (poses.configurations.rows() < count) return std::nullopt;
    poses.configurations.conservativeResize(count, Eigen::NoChange);
    poses.is_seen.conservativeResize(count, Eigen::NoChange);
    if (!poses.is_seen.colwise().any().all()) return std::nullopt;
    return poses;
}

ShownPoses draw_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                      const std::function<RowMatrixXd(Index count)>& draw) {
    const std::vector<std::string> contacts = campaign.sensor->contact_names();
    if (contacts.empty()) return {draw(count), all_seen(count, campaign.sensor->target_count())};
    const bool is_stated = campaign.has_nominal_targets;  // else some place may be out of reach
    const Index least = std::max(2 * count, 16 * std::ssize(contacts));
    ShownPoses poses;
    for (const Index share : {1, 4, 32}) {
        poses = bring_to_contacts(campaign, parameters, draw(share * least), 0,
                                  limits_of(campaign.robot));
        const bool reaches_all = poses.is_seen.colwise().any().all();
        if (poses.configurations.rows() < count || (is_stated && !reaches_all)) continue;
        poses.configurations.conservativeResize(count, Eigen::NoChange);
        poses.is_seen.conservativeResize(count, Eigen::NoChange);
        return poses;
    }
    std::vector<std::string> unreached;
    for (Index k = 0; k < std::ssize(contacts); ++k) {
        if (!poses.is_seen.col(k).any()) unreached.push_back(contacts[static_cast<std::size_t>(k)]);
    }
    throw InputError(fmt::format(
        "hardly any configuration within the joint limits puts the ball into {}; must be within "
        "reach as stated, keys sensor.sockets and {}",
        unreached.empty() ? "a socket" : fmt::format("{}", fmt::join(unreached, ", ")),
        campaign.sensor->words().key));
}

double needed_clearance(Eigen::Ref<VectorXd> clearances, Index needed) {
    const auto nth = clearances.begin() + std::min(needed, clearances.size()) - 1;
    std::nth_element(clearances.begin(), nth, clearances.end(), std::greater<>());
    return *nth;
}

View view_at(const Campaign& campaign, const Parameters& parameters, const VectorXd& q) {
    const Sensor& sensor = *campaign.sensor;
    VectorXd clearances(sensor.target_count());
    sensor.view_clearances(world_from_flange(campaign, parameters, q), parameters.sensor,
                           clearances);
    View view{clearances.transpose().array() >= 0};
    view.clearance = needed_clearance(clearances, sensor.least_in_view());
    return view;
}

ViewedPoses viewed_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                         std::uint64_t seed) {
    const Sensor& sensor = *campaign.sensor;
    std::vector<std::pair<double, Index>> hidden;  // by how much, 0: it is in view
    RowMatrixXd drawn;
    Seen in_view;
    for (const Index drawn_for_each : {64, 1024}) {  // few see a board that lies on a table
        drawn = random_configurations(campaign.robot, drawn_for_each * count, seed);
        in_view.resize(drawn.rows(), sensor.target_count());
        hidden.clear();
        Index found = 0;
        for (Index i = 0; i < drawn.rows() && found < count; ++i) {
            const View view = view_at(campaign, parameters, drawn.row(i).transpose());
            in_view.row(i) = view.is_seen;
            hidden.emplace_back(std::max(0.0, -view.clearance), i);
            if (view.clearance >= 0) ++found;
        }
        std::ranges::sort(hidden);
        if (found == count) break;
    }
    ViewedPoses poses{{RowMatrixXd(count, drawn.cols()), Seen(count, sensor.target_count())}, 0};
    for (Index k = 0; k < count; ++k) {
        const auto& [by, i] = hidden[static_cast<std::size_t>(k)];
        poses.configurations.row(k) = drawn.row(i);
        // A corner out of view may be near the camera's plane, where it moves beyond all others.
        poses.is_seen.row(k) = in_view.row(i);
        if (by > 0) {
            poses.is_seen.row(k).setConstant(true);
        } else {
            ++poses.in_view;
        }
    }
    return poses;
}

Isometry3d base_in_view(const Campaign& campaign) {
    constexpr Index pose_count = 32;
    constexpr Index direction_count = 32;
    constexpr std::uint64_t seed = 20154;  // any: it only has to be the same every time
    const Sensor& sensor = *campaign.sensor;
    const RowMatrixXd drawn = random_configurations(campaign.robot, pose_count, seed);
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    std::vector<Isometry3d> flanges;
    Vector3d middle = Vector3d::Zero();
    for (Index i = 0; i < pose_count; ++i) {
        flanges.push_back(campaign.robot.base_from_flange(drawn.row(i).transpose(), no_errors));
        middle += flanges.back().translation() / static_cast<double>(pose_count);
    }
    double reach = 0.1;  // m, where the flange hardly moves
    for (const Isometry3d& flange : flanges) {
        reach = std::max(reach, (flange.translation() - middle).norm());
    }
    RandomStream directions(seed);
    Isometry3d best = Isometry3d::Identity();
    Index least_hidden = pose_count * sensor.target_count() + 1;
    VectorXd clearances(sensor.target_count());
    for (Index k = 0; k < direction_count; ++k) {
        const Eigen::Quaterniond turn(directions.normal(), directions.normal(), directions.normal(),
                                      directions.normal());
        for (const double distance : {1.5 * reach, 3 * reach, 6 * reach}) {
            const Isometry3d base = Eigen::Translation3d(0, 0, distance) * turn.normalized() *
                                    Eigen::Translation3d(-middle);
            Index hidden = 0;
            for (const Isometry3d& flange : flanges) {
                sensor.view_clearances(base * flange, campaign.nominal.sensor, clearances);
                hidden += sensor.target_count() - (clearances.array() >= 0).count();
                if (hidden >= least_hidden) break;
            }
            if (hidden >= least_hidden) continue;
            least_hidden = hidden;
            best = base;
        }
    }
    return best;
}

ShownPoses random_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                        std::uint64_t seed) {
    return draw_poses(campaign, parameters, count, [&](Index drawn) {
        return random_configurations(campaign.robot, drawn, seed);
    });
}

}  // namespace posewise::detail
