#include "choice_problem.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "choice_cell.hpp"
#include "core/checksum.hpp"
#include "core/decompositions.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "measurement/contact.hpp"
#include "measurement/noise.hpp"
#include "measurement/prior_rows.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
#include "selection/bound.hpp"
#include "task/calibration/calibration_options.hpp"
#include "task/calibration/inputs.hpp"

namespace posewise::detail {
namespace {

constexpr double same_joints = 1e-6;  // rad or m
constexpr Index at_once = 4096;       // candidates whose blocks are made

void hold(ChoiceProblem& problem, const RowMatrixXd& rows) {
    problem.options.held_rows = stack(problem.options.held_rows, rows);
}

/// Blocks beside the candidates must have as many columns.
void check_columns(const ChoiceProblem& problem, const Blocks& blocks, const std::string& name) {
    if (blocks.parameter_count() == problem.blocks.parameter_count()) return;
    compute_from(name, [&]() -> int {
        throw InputError("has " + std::to_string(blocks.parameter_count()) +
                         " columns, must have " + std::to_string(problem.blocks.parameter_count()) +
                         " as the candidates");
    });
}

void hold_blocks(ChoiceProblem& problem, const Blocks& measured) {
    check_columns(problem, measured, problem.request.sources.augment);
    hold(problem, measured.matrix);
    problem.options.held_pose_count = measured.count();
    for (Index i = 0; i < problem.blocks.count(); ++i) {
        for (Index k = 0; k < measured.count(); ++k) {
            if (problem.blocks[i] == measured[k]) problem.options.excluded.push_back(i);
        }
    }
}

/// Blocks of random candidates, part by part until `stop` comes.
void make_random_blocks(ChoiceProblem& problem, const Campaign& campaign,
                        const Parameters& parameters, const StopSignal& stop) {
    const Index count = problem.configurations.rows();
    Blocks& blocks = problem.blocks;
    blocks.matrix.resize(campaign.sensor->row_count() * count, parameter_count(campaign));
    Index made = 0;
    while (made < count && !(made > 0 && stop.is_set())) {
        const Index size = std::min(count - made, at_once);
        const Blocks part = make_blocks(
            campaign, parameters, problem.configurations.middleRows(made, size),
            RowMatrixXd(problem.request.repeats * problem.share.middleRows(made, size)));
        const Index begin = blocks.first_row.back();
        blocks.matrix.middleRows(begin, part.matrix.rows()) = part.matrix;
        for (Index i = 1; i <= size; ++i) {
            blocks.first_row.push_back(begin + part.first_row[static_cast<std::size_t>(i)]);
        }
        made += size;
    }
    blocks.matrix.conservativeResize(blocks.first_row.back(), Eigen::NoChange);
    problem.configurations.conservativeResize(made, Eigen::NoChange);
    problem.share.conservativeResize(made, Eigen::NoChange);
    problem.ids.resize(static_cast<std::size_t>(made));
}

/// RMS of the standard deviations of a reading's lengths (m) and angles (rad).
std::array<double, 2> reading_deviations(const Campaign& campaign, const Parameters& parameters,
                                         const RowMatrixXd& configurations,
                                         const RowMatrixXd& repeats) {
    std::array<double, 2> squares{}, counts{};
    PoseNoise noise(campaign);
    FlangeMotion motion;
    for (const Index i : evenly_spaced(configurations.rows(), at_once)) {
        const VectorXd times = repeats.row(i).transpose();
        if ((times.array() == 0).all()) continue;
        differentiate_flange(campaign, parameters, configurations.row(i).transpose(), motion);
        const MatrixXd& covariance = noise.covariance(motion, parameters.sensor, times);
        for (Index k = 0; k < covariance.rows(); ++k) {
            const std::size_t kind =
                campaign.sensor->is_angle(noise.rows()[static_cast<std::size_t>(k)]) ? 1 : 0;
            squares[kind] += covariance(k, k);
            ++counts[kind];
        }
    }
    const auto rms = [&](std::size_t kind) { return std::sqrt(squares[kind] / counts[kind]); };
    return {rms(0), rms(1)};
}

/// G and V predict the readings at test poses, each divided by what one deviates on average. (The
/// noise of one pose correlates its readings, which matters for what they tell, not for what is
/// predicted.)
void state_test_poses(ChoiceProblem& problem, const Campaign& campaign,
                      const RowMatrixXd& configurations, const RowMatrixXd& repeats) {
    const Sensor& sensor = *campaign.sensor;
    const VectorXd scale = parameter_scale(campaign);
    const auto deviations =
        reading_deviations(campaign, problem.parameters, configurations, repeats);
    problem.reading_deviation = deviations[0];
    const bool is_mean = problem.request.criterion == Criterion::V;
    auto& made = problem.test_poses = std::make_unique<Blocks>();
    for (Index first = 0; first < configurations.rows(); first += at_once) {
        const Index size = std::min(configurations.rows() - first, at_once);
        Blocks part = make_plain_blocks(campaign, problem.parameters,
                                        RowMatrixXd(configurations.middleRows(first, size)),
                                        RowMatrixXd(repeats.middleRows(first, size)));
        part.matrix *= scale.asDiagonal();
        for (Index i = 0; i < size; ++i) {
            Index row = part.first_row[static_cast<std::size_t>(i)];
            for (const Index of_all : seen_rows(sensor, repeats.row(first + i).array() > 0)) {
                part.matrix.row(row++) /= deviations[sensor.is_angle(of_all) ? 1 : 0];
            }
        }
        if (is_mean) {
            made->matrix = lower_root_of_gram(stack(made->matrix, part.matrix)).transpose();
            continue;
        }
        const Index begin = made->first_row.back();
        made->matrix = stack(made->matrix, part.matrix);
        for (Index i = 1; i <= size; ++i) {
            made->first_row.push_back(begin + part.first_row[static_cast<std::size_t>(i)]);
        }
    }
    if (!is_mean) return;
    made->matrix /= std::sqrt(static_cast<double>(configurations.rows()));
    made->first_row = {0, made->matrix.rows()};
}

/// Of all that candidates are: ids, joints, what was measured, what is seen.
std::string checksum_of(const ChoiceProblem& problem, const Candidates& candidates) {
    Checksum checksum;
    if (candidates.measured) checksum.add(candidates.measured->observations);
    for (const std::string& id : problem.ids) checksum.add(id);
    checksum.add(problem.configurations);
    if ((problem.share.array() < 1).any()) checksum.add(problem.share);
    return checksum.text();
}

/// Base and targets: registered from the candidates' measurements, else as the campaign states
/// them, else registered from the poses measured already.
Parameters find_parameters(const Campaign& campaign, const Candidates& candidates,
                           const ChoiceOptions& options) {
    const std::string& held = options.sources.augment;
    const bool is_stated = campaign.has_nominal_base && campaign.has_nominal_targets;
    if (options.held && (candidates.measured || is_stated)) {
        check_measured(campaign, *options.held, held);
    }
    if (candidates.measured) {
        return register_measured(campaign, *candidates.measured, options.sources.candidates);
    }
    if (is_stated) return campaign.nominal;
    if (options.held) return register_measured(campaign, *options.held, held);
    if (can_assume_places(campaign)) return campaign.nominal;
    if (campaign.sensor->has_contacts()) throw unstated_contacts(campaign);
    throw InputError(campaign.name +
                     ": the campaign file states no base, on which what this sensor tells depends, "
                     "and nothing was measured to find it from; state base there, or choose "
                     "from measured configurations (`measured`)");
}

/// Throws InputError for a candidate that is nowhere near what it is said to touch.
void check_contacts(const ChoiceProblem& problem, const Campaign& campaign,
                    const Parameters& parameters) {
    constexpr double near = 0.1;  // m: as far as places may be off that are stated roughly
    const Sensor& sensor = *campaign.sensor;
    const std::vector<std::string> names = sensor.contact_names();
    const Index width = sensor.rows_per_target();
    for (Index i = 0; i < problem.configurations.rows() && !names.empty(); ++i) {
        const VectorXd q = problem.configurations.row(i).transpose();
        const VectorXd misses =
            sensor.predict(world_from_flange(campaign, parameters, q), parameters.sensor);
        for (Index k = 0; k < std::ssize(names); ++k) {
            const double miss = misses.segment(width * k, width).norm();
            if (problem.share(i, k) <= 0 || miss <= near) continue;
            throw InputError(fmt::format(
                "candidate {} is {} mm from {}; must touch it, within 100 mm of where the campaign "
                "or an estimate (`earlier`) says that it is; candidates that are drawn (`count`) "
                "do",
                quote(problem.ids[static_cast<std::size_t>(i)]), format_short(mm_per_m * miss, 4),
                names[static_cast<std::size_t>(k)]));
        }
    }
}

void hold_measured(ChoiceProblem& problem, const Campaign& campaign, const Parameters& parameters,
                   const Measurements& measured) {
    hold(problem, measured_blocks(campaign, parameters, measured).matrix);
    problem.options.held_pose_count = measured.configuration_count();
    const Index joints = campaign.robot.joint_count();
    for (Index i = 0; i < problem.configurations.rows(); ++i) {
        const auto distance = (measured.configurations.leftCols(joints).rowwise() -
                               problem.configurations.row(i).head(joints))
                                  .cwiseAbs();
        if (distance.rowwise().maxCoeff().minCoeff() <= same_joints) {
            problem.options.excluded.push_back(i);
        }
    }
}

void state_limits(ChoiceProblem& problem, const std::vector<Index>& groups) {
    const PlanRequest& request = problem.request;
    SelectOptions& options = problem.options;
    options.criterion = request.criterion;
    options.pose_count = request.pose_count;
    options.starts = request.starts;
    options.proof = request.proof;
    options.seed = request.seed.value();
    options.test_poses = problem.test_poses.get();
    options.repeat_limit = request.repeat_limit;
    options.least_distance = request.least_distance;
    if (options.least_distance > 0 && options.positions.rows() == 0) {
        throw InputError("candidates without joints have no least distance; must be 0");
    }
    options.group_limit = request.group_limit;
    options.groups = groups;
    if (problem.kind == CandidateKind::Random && groups.size() > problem.ids.size()) {
        options.groups.resize(problem.ids.size());  // of those there was time for
    }
    const CandidateIndex index(problem.ids, request.excluded);
    compute_from(name_of(request.sources), [&] {
        for (const std::string& id : request.excluded) {
            options.excluded.push_back(index.find(id, "excluded candidate"));
        }
    });
}

/// The test poses with the targets that they show: all, or of a sensor with a view those in it.
/// Poses that show too little are left out and noted. Throws InputError if none is left.
ShownPoses shown_tests(ChoiceProblem& problem, const Campaign& campaign,
                       const ChoiceOptions& options) {
    const Sensor& sensor = *campaign.sensor;
    const Index count = options.test_poses.rows();
    ShownPoses tests{options.test_poses, all_seen(count, sensor.target_count())};
    if (!sensor.has_view() || count == 0) return tests;
    Index kept = 0;
    for (Index i = 0; i < count; ++i) {
        const VectorXd q = options.test_poses.row(i).transpose();
        const View view = view_at(campaign, problem.parameters, q);
        if (view.clearance < 0) continue;
        tests.configurations.row(kept) = q.transpose();
        tests.is_seen.row(kept++) = view.is_seen;
    }
    if (kept == count) return tests;
    const std::string& name = options.sources.test_poses;
    if (kept == 0) {
        throw InputError(name + ": no test pose shows what the sensor sees; one must");
    }
    tests.configurations.conservativeResize(kept, Eigen::NoChange);
    tests.is_seen.conservativeResize(kept, Eigen::NoChange);
    problem.cell_doubts.push_back(
        fmt::format("{} of {} test poses show too little of what the sensor sees: left out",
                    count - kept, count));
    return tests;
}

void check_test_poses(const ChoiceOptions& options, Criterion criterion) {
    const bool has_any = options.test_poses.rows() > 0 || options.test_blocks.count() > 0;
    if (!has_any || needs_test_poses(criterion)) return;
    const std::string& name = options.sources.test_poses;
    throw InputError("test poses are " + (name.empty() ? "given" : name) + ", but criterion " +
                     std::string(criterion_name(criterion)) +
                     " does not look at them; must be g or v");
}

}  // namespace

const std::string& name_of(const PlanSources& sources) {
    return sources.candidates.empty() ? sources.campaign : sources.candidates;
}

void judge_candidates(const Campaign& campaign, const std::optional<Measurements>& measured,
                      const ChoiceOptions& options) {
    if (!measured) return;
    compute_from(options.sources.candidates,
                 [&] { judge_measured(campaign, *measured, options.judge, options.stop); });
}

std::vector<std::string> ids_of(const std::vector<PlannedPose>& poses) {
    std::vector<std::string> ids;
    for (const PlannedPose& pose : poses) ids.push_back(pose.id);
    return ids;
}

std::vector<Index> candidates_of(const ChoiceProblem& problem,
                                 const std::vector<PlannedPose>& poses) {
    const CandidateIndex index(problem.ids, ids_of(poses));
    std::vector<Index> chosen;
    for (const PlannedPose& pose : poses) {
        const Index candidate = index.find(pose.id, "pose");
        chosen.insert(chosen.end(), static_cast<std::size_t>(pose.times), candidate);
    }
    return chosen;
}

MatrixXd information_of(const ChoiceProblem& problem, const std::vector<PlannedPose>& poses) {
    return information_of(problem.options.held_rows, problem.blocks.parameter_count()) +
           information(problem.blocks, candidates_of(problem, poses));
}

RowMatrixXd workspace_of(const ChoiceProblem& problem) {
    constexpr Index most_configurations = 500;
    const auto workspace = evenly_spaced(problem.configurations.rows(), most_configurations);
    return problem.configurations(workspace, Eigen::all);
}

CandidateIndex::CandidateIndex(const std::vector<std::string>& ids,
                               const std::vector<std::string>& wanted) {
    const std::unordered_set<std::string> among(wanted.begin(), wanted.end());
    if (among.empty()) return;
    for (std::size_t i = 0; i < ids.size(); ++i) {
        if (among.contains(ids[i])) index_.emplace(ids[i], static_cast<Index>(i));
    }
}

Index CandidateIndex::find(const std::string& id, const std::string& what) const {
    const auto found = index_.find(id);
    if (found == index_.end()) {
        throw InputError(what + " '" + id + "' is not among the candidates; must be the id of one");
    }
    return found->second;
}

ChoiceProblem state_choice(Blocks candidates, const ChoiceOptions& options) {
    ChoiceProblem problem;
    problem.request = options;
    complete(problem.request, Criterion::D);
    check_test_poses(options, problem.request.criterion);
    if (problem.request.repeats == 0) problem.request.repeats = 1;
    problem.blocks = std::move(candidates);
    problem.ids = number_ids(problem.blocks.count());
    Checksum checksum;
    checksum.add(problem.blocks.matrix);
    problem.checksum = checksum.text();
    if (options.has_prior) {
        const Index L = problem.blocks.parameter_count();
        hold(problem, RowMatrixXd::Identity(L, L));
    }
    if (options.held_blocks.matrix.rows() > 0) hold_blocks(problem, options.held_blocks);
    if (options.test_blocks.count() > 0) {
        check_columns(problem, options.test_blocks, options.sources.test_poses);
        problem.test_poses = std::make_unique<Blocks>(options.test_blocks);
    }
    state_limits(problem, options.groups);
    return problem;
}

ChoiceProblem state_choice(const Campaign& campaign, Candidates candidates,
                           const ChoiceOptions& options, const StopSignal& stop) {
    ChoiceProblem problem;
    PlanRequest& request = problem.request = options;
    complete(request, campaign.criterion, candidates.seed.value_or(campaign.seed));
    if (candidates.seed && *request.seed != *candidates.seed) {
        throw InputError(fmt::format(
            "`seed` is {}, the random candidates were drawn with {}; must be that or unstated",
            *request.seed, *candidates.seed));
    }
    check_test_poses(options, request.criterion);
    if (request.focus != Focus::All) check_takes_nuisance(request.criterion);
    problem.kind = candidates.kind;
    problem.ids = std::move(candidates.ids);
    problem.configurations = std::move(candidates.configurations);
    problem.share = std::move(candidates.share);
    request.has_prior = campaign.spread.is_prior;
    if (request.repeats == 0) {
        request.repeats = candidates.measured ? mean_repeats(*candidates.measured) : 1;
    }
    const Parameters& parameters = problem.parameters =
        find_parameters(campaign, candidates, options);
    if (candidates.kind == CandidateKind::Random) {
        make_random_blocks(problem, campaign, parameters, stop);
    } else {
        if (!candidates.measured) {
            compute_from(request.sources.candidates, [&] {
                check_contacts(problem, campaign, parameters);
                heed_cell(problem, campaign, options.held.has_value());
            });
        }
        problem.blocks = make_blocks(campaign, parameters, problem.configurations,
                                     RowMatrixXd(request.repeats * problem.share));
    }
    add_unchecked_bodies(problem, campaign);
    problem.checksum = checksum_of(problem, candidates);
    problem.options.column_names = parameter_names(campaign);
    if (prior_count(campaign) > 0) hold(problem, prior_rows(campaign));
    if (options.held) hold_measured(problem, campaign, parameters, *options.held);
    problem.options.nuisance = nuisance_of(request.focus, campaign);
    if (request.least_distance > 0) {
        problem.options.positions = turning_joints(campaign.robot, problem.configurations);
    }
    const bool has_tests = options.test_poses.rows() > 0;
    const ShownPoses tests = shown_tests(problem, campaign, options);
    const RowMatrixXd once = tests.is_seen.cast<double>();
    if (common_part(campaign) > 0 && needs_test_poses(request.criterion)) {
        state_test_poses(problem, campaign,
                         has_tests ? tests.configurations : problem.configurations,
                         request.repeats * (has_tests ? once : problem.share));
    } else if (has_tests) {
        problem.test_poses = std::make_unique<Blocks>(make_blocks(
            campaign, parameters, tests.configurations, RowMatrixXd(request.repeats * once)));
    }
    state_limits(problem, options.groups);
    return problem;
}

}  // namespace posewise::detail
