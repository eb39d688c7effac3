#include "selection_problem.hpp"

#include <numeric>

#include "common.hpp"
#include "files.hpp"
#include "measured.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/checksum.hpp"
#include "posewise/io/groups_file.hpp"
#include "posewise/io/matrix_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/halton.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::cli {
namespace {

using Kind = io::CandidateSource::Kind;

constexpr double same_joints = 1e-6;  // rad or m
constexpr Index drawn_at_once = 4096;

std::vector<std::string> number_ids(Index count) {
    std::vector<std::string> ids;
    for (Index i = 0; i < count; ++i) ids.push_back(std::to_string(i));
    return ids;
}

/// Held information there is none of yet.
MatrixXd& held(SelectionProblem& problem) {
    const Index L = problem.blocks.parameter_count();
    if (problem.options.held.size() == 0) problem.options.held = MatrixXd::Zero(L, L);
    return problem.options.held;
}

// ---- Plain blocks ----

Blocks read_blocks(const io::CandidateSource& source, const std::string& path) {
    const RowMatrixXd matrix = io::read_matrix(path, source.variable);
    try {
        return make_equal_blocks(matrix, source.rows_per_block);
    } catch (const InputError& error) {
        throw input_error_at({path}, error.what());
    }
}

/// Blocks beside the candidates, of as many columns.
Blocks read_more_blocks(const SelectionProblem& problem, const std::string& path) {
    Blocks blocks = read_blocks(problem.request.source, path);
    if (blocks.parameter_count() != problem.blocks.parameter_count()) {
        throw input_error_at(
            {path}, "has " + std::to_string(blocks.parameter_count()) + " columns, must have " +
                        std::to_string(problem.blocks.parameter_count()) + " as the candidates");
    }
    return blocks;
}

void hold_plain_blocks(SelectionProblem& problem) {
    const Blocks measured = read_more_blocks(problem, problem.request.augment);
    held(problem) += information(measured);
    problem.options.held_pose_count = measured.count();
    for (Index i = 0; i < problem.blocks.count(); ++i) {
        for (Index k = 0; k < measured.count(); ++k) {
            if (problem.blocks[i] == measured[k]) problem.options.excluded.push_back(i);
        }
    }
}

void state_plain(SelectionProblem& problem) {
    const io::SelectionRequest& request = problem.request;
    problem.blocks = read_blocks(request.source, request.source.path);
    problem.ids = number_ids(problem.blocks.count());
    io::Checksum checksum;
    checksum.add(problem.blocks.matrix);
    problem.checksum = checksum.text();
    if (request.has_prior) held(problem).diagonal().array() += 1;
    if (!request.augment.empty()) hold_plain_blocks(problem);
    if (!request.test_poses.empty()) {
        problem.test_poses =
            std::make_unique<Blocks>(read_more_blocks(problem, request.test_poses));
    }
}

// ---- A robot ----

/// Candidates of a file.
struct Candidates {
    std::optional<Measurements> measured;
    RowMatrixXd share;  ///< of a candidate's samples in which each target is seen
};

Candidates read_candidates(SelectionProblem& problem) {
    const io::CandidateSource& source = problem.request.source;
    Candidates candidates;
    if (source.kind == Kind::Configurations) {
        auto [ids, joints, is_seen] = io::read_configurations(source.path, *problem.campaign);
        problem.ids = std::move(ids);
        problem.configurations = std::move(joints);
        candidates.share = is_seen.cast<double>();
    } else if (source.kind == Kind::Measurements) {
        const Measurements& measured =
            candidates.measured.emplace(read_measured(source.path, *problem.campaign));
        check_is_of_robot(*problem.campaign, measured, source.path);
        problem.ids = measured.ids;
        problem.configurations = measured.configurations;
        candidates.share = share_seen(measured);
    }
    return candidates;
}

/// Random candidates and their blocks, part by part until `stop` comes; all targets are seen.
void draw_candidates(SelectionProblem& problem, const Parameters& parameters,
                     const StopSignal& stop) {
    const Campaign& campaign = *problem.campaign;
    io::CandidateSource& source = problem.request.source;
    const Index rows = campaign.sensor->row_count();
    check_memory(campaign, source.count, "--random");
    RowMatrixXd& configurations = problem.configurations;
    Blocks& blocks = problem.blocks;
    configurations.resize(source.count, campaign.robot.joint_count());
    blocks.matrix.resize(rows * source.count, parameter_count(campaign));
    Index drawn = 0;
    while (drawn < source.count && !(drawn > 0 && stop.is_set())) {
        const Index size = std::min(source.count - drawn, drawn_at_once);
        const RowMatrixXd part =
            halton_configurations(campaign.robot, size, {{}, 1 + drawn, source.seed});
        configurations.middleRows(drawn, size) = part;
        blocks.matrix.middleRows(rows * drawn, rows * size) =
            make_blocks(campaign, parameters, part, source.repeats).matrix;
        drawn += size;
    }
    configurations.conservativeResize(drawn, Eigen::NoChange);
    blocks.matrix.conservativeResize(rows * drawn, Eigen::NoChange);
    for (Index i = 1; i <= drawn; ++i) blocks.first_row.push_back(rows * i);
    problem.ids = number_ids(drawn);
    source.count = drawn;
}

/// Of all that candidates are: ids, joints, what was measured, what is seen.
std::string checksum_of(const SelectionProblem& problem, const Candidates& candidates) {
    io::Checksum checksum;
    if (candidates.measured) checksum.add(candidates.measured->observations);
    for (const std::string& id : problem.ids) checksum.add(id);
    checksum.add(problem.configurations);
    if ((candidates.share.array() < 1).any()) checksum.add(candidates.share);
    return checksum.text();
}

/// Base and targets: registered from the candidates' measurements, else as the campaign states
/// them, else registered from the poses measured already.
Parameters find_parameters(const SelectionProblem& problem,
                           const std::optional<Measurements>& candidates,
                           const std::optional<Measurements>& augment) {
    const Campaign& campaign = *problem.campaign;
    const auto register_from = [&](const std::string& path, const Measurements& measured) {
        return compute_from(
            path, [&] { return determined(register_base_and_targets(campaign, measured)); });
    };
    if (candidates) return register_from(problem.request.source.path, *candidates);
    if (campaign.has_nominal_base && campaign.has_nominal_targets) return campaign.nominal;
    if (augment) return register_from(problem.request.augment, *augment);
    const std::string key = campaign.sensor->words().key;
    throw InputError(campaign.name + ": the campaign file states no " +
                     (campaign.has_nominal_base ? key : "base") +
                     ", and nothing was measured to find them from; state base and " + key +
                     " there, or use --measurements");
}

void hold_measured(SelectionProblem& problem, const Parameters& parameters,
                   const Measurements& measured) {
    held(problem) += information(make_blocks(*problem.campaign, parameters, measured.configurations,
                                             mean_repeats(measured) * share_seen(measured)));
    problem.options.held_pose_count = measured.configuration_count();
    const Index joints = problem.campaign->robot.joint_count();
    for (Index i = 0; i < problem.configurations.rows(); ++i) {
        const auto distance = (measured.configurations.leftCols(joints).rowwise() -
                               problem.configurations.row(i).head(joints))
                                  .cwiseAbs();
        if (distance.rowwise().maxCoeff().minCoeff() <= same_joints) {
            problem.options.excluded.push_back(i);
        }
    }
}

void focus_on_robot(SelectionProblem& problem) {
    problem.options.nuisance = nuisance_of_robot(*problem.campaign);
}

/// Angles of the joints that turn: what distances between poses are taken of.
RowMatrixXd turning_joints(const Chain& robot, const RowMatrixXd& configurations) {
    std::vector<Index> turning;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        if (robot.joint(j).motion == Motion::Rotation) turning.push_back(j);
    }
    return configurations(Eigen::all, turning);
}

void state_with_robot(SelectionProblem& problem, const StopSignal& stop) {
    io::SelectionRequest& request = problem.request;
    problem.campaign = io::read_campaign(request.source.campaign);
    problem.campaign->spread.is_prior = request.has_prior;
    const Campaign& campaign = *problem.campaign;
    const Candidates candidates = read_candidates(problem);
    const std::optional<Measurements>& measured = candidates.measured;
    if (request.source.repeats == 0) {
        request.source.repeats = measured ? mean_repeats(*measured) : 1;
    }
    std::optional<Measurements> augment;
    if (!request.augment.empty()) {
        augment = read_measured(request.augment, *problem.campaign);
        check_is_of_robot(campaign, *augment, request.augment);
    }
    if (request.source.kind == Kind::Random) {
        check_torques_known(request.source.campaign, campaign.robot);
    }
    const Parameters parameters = find_parameters(problem, measured, augment);
    if (request.source.kind == Kind::Random) {
        draw_candidates(problem, parameters, stop);
    } else {
        problem.blocks = make_blocks(campaign, parameters, problem.configurations,
                                     request.source.repeats * candidates.share);
    }
    problem.checksum = checksum_of(problem, candidates);
    problem.options.column_names = parameter_names(campaign);
    if (request.has_prior) held(problem) += prior_information(campaign);
    if (augment) hold_measured(problem, parameters, *augment);
    if (request.is_focused_on_robot) focus_on_robot(problem);
    if (request.least_distance > 0) {
        problem.options.positions = turning_joints(campaign.robot, problem.configurations);
    }
    if (!request.test_poses.empty()) {
        problem.test_poses = std::make_unique<Blocks>(
            make_blocks(campaign, parameters,
                        io::read_configurations(request.test_poses, *problem.campaign).joints,
                        request.source.repeats));
    }
}

// ---- Both ----

void state_limits(SelectionProblem& problem) {
    const io::SelectionRequest& request = problem.request;
    SelectOptions& options = problem.options;
    options.criterion = request.criterion;
    options.pose_count = request.pose_count;
    options.test_poses = problem.test_poses.get();
    options.repeat_limit = request.repeat_limit;
    options.least_distance = request.least_distance;
    options.group_limit = request.group_limit;
    if (!request.groups.empty()) options.groups = io::read_groups(request.groups, problem.ids);
    const CandidateIndex index(problem.ids);
    for (const std::string& id : request.excluded) {
        options.excluded.push_back(index.find(id, "excluded candidate"));
    }
}

void check_test_poses(const io::SelectionRequest& request) {
    if (request.test_poses.empty() || needs_test_poses(request.criterion)) {
        return;
    }
    throw InputError("test poses are " + request.test_poses + ", but criterion " +
                     std::string(criterion_name(request.criterion)) +
                     " does not look at them; must be g or v");
}

}  // namespace

CandidateIndex::CandidateIndex(const std::vector<std::string>& ids) {
    for (std::size_t i = 0; i < ids.size(); ++i) index_.emplace(ids[i], static_cast<Index>(i));
}

Index CandidateIndex::find(const std::string& id, const std::string& what) const {
    const auto found = index_.find(id);
    if (found == index_.end()) {
        throw InputError(what + " '" + id + "' is not among the candidates");
    }
    return found->second;
}

SelectionProblem read_problem(io::SelectionRequest request, const StopSignal& stop) {
    check_test_poses(request);
    SelectionProblem problem;
    problem.request = std::move(request);
    if (problem.request.source.kind == Kind::Blocks) {
        if (problem.request.source.repeats == 0) problem.request.source.repeats = 1;
        state_plain(problem);
    } else {
        state_with_robot(problem, stop);
    }
    state_limits(problem);
    return problem;
}

}  // namespace posewise::cli
