#include "least_squares.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/decompositions.hpp"
#include "core/products.hpp"
#include "core/text.hpp"
#include "jacobian/whitened_pose.hpp"
#include "measurement/noise.hpp"
#include "normal_equations.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "robust.hpp"
#include "variances.hpp"

namespace posewise::detail {

namespace {

void check_size(const Campaign& campaign, const Measurements& measurements) {
    const Sensor& sensor = *campaign.sensor;
    if (measurements.configurations.cols() != campaign.robot.configuration_size()) {
        throw InputError(fmt::format(
            "configurations have {} numbers, the robot's have {}: joints and measured torques",
            measurements.configurations.cols(), campaign.robot.configuration_size()));
    }
    if (measurements.observations.cols() != sensor.row_count()) {
        throw InputError(fmt::format("an observation has {} numbers, the sensor returns {}",
                                     measurements.observations.cols(), sensor.row_count()));
    }
    if (measurements.is_seen.rows() != measurements.observations.rows() ||
        measurements.is_seen.cols() != sensor.target_count()) {
        throw InputError(fmt::format("is_seen is {} x {}, must be samples x targets, {} x {}",
                                     measurements.is_seen.rows(), measurements.is_seen.cols(),
                                     measurements.observations.rows(), sensor.target_count()));
    }
}

/// Columns for the flange's six ways to move, the sensor's unknowns and the residual.
Index narrow_width(const Parameters& parameters) { return 7 + parameters.sensor.size(); }

/// Of one configuration after another what the measurements tell, in memory that it takes once.
class Configurations {
  public:
    explicit Configurations(const IdentificationProblem& problem)
        : problem_(problem),
          sensor_(*problem.campaign.sensor),
          noise_(problem.campaign),
          q_(problem.campaign.robot.configuration_size()),
          repeats_(problem.repeats.cols()),
          predicted_(sensor_.row_count()),
          deviation_(sensor_.row_count()) {}

    Index count() const { return problem_.means.configuration_count(); }

    /// The whitened equations of the targets seen, J and r, weighted, in the first rows of `all`
    /// (all that an observation would have x L + 1); returns how many they are.
    Index state(Index i, const Parameters& parameters, Eigen::Ref<RowMatrixXd> all) {
        go_to(i);
        differentiate_pose(problem_.campaign, parameters, q_, motion_,
                           all.leftCols(all.cols() - 1));
        return finish(i, parameters, all);
    }

    /// Does the same in no more than narrow_width() rows. J = A E (WhitenedPose), where A is the
    /// readings' derivative by the flange's six ways to move and by the sensor's unknowns. With
    /// [A r] = Q [R z; 0 s] whitened and weighted, |J d - r|^2 = |R E d - z|^2 + s^2.
    Index state_narrowly(Index i, const Parameters& parameters, Eigen::Ref<RowMatrixXd> all) {
        go_to(i);
        differentiate_flange(problem_.campaign, parameters, q_, motion_);
        const Index columns = 6 + parameters.sensor.size();
        readings_.resize(sensor_.row_count(), columns + 1);
        sensor_.differentiate(motion_.world_from_flange, TwistMatrix::Identity(6, 6),
                              parameters.sensor, readings_.leftCols(columns));
        RowMatrixXd R;
        if (problem_.loss.kind == LossKind::Squares) {
            readings_.rightCols(1) = deviate(i, parameters);
            R = noise_.triangle_of_seen(motion_, parameters.sensor, repeats_, readings_);
        } else {
            R = triangular_factor(readings_.topRows(finish(i, parameters, readings_)));
        }
        spread(R.leftCols(columns), motion_.twists, all.topLeftCorner(R.rows(), all.cols() - 1));
        all.rightCols(1).topRows(R.rows()) = R.rightCols(1);
        return R.rows();
    }

    /// Does the same as state() with other columns in the place of J.
    Index state_columns(Index i, const Parameters& parameters, const FillColumns& fill,
                        Eigen::Ref<RowMatrixXd> all) {
        go_to(i);
        place_flange(parameters);
        fill(i, all.leftCols(all.cols() - 1));
        return finish(i, parameters, all);
    }
    /// Returns the sum of squares of the whitened residuals; quicker than measure().
    double square(Index i, const Parameters& parameters, const Parameters& of_noise) {
        go_to(i);
        place_flange(parameters);
        readings_.resize(sensor_.row_count(), 7);
        readings_.rightCols(1) = deviate(i, parameters);
        if (&of_noise != &parameters) place_flange(of_noise);
        sensor_.differentiate(motion_.world_from_flange, TwistMatrix::Identity(6, 6),
                              of_noise.sensor, readings_.leftCols<6>());
        return noise_.triangle_of_seen(motion_, of_noise.sensor, repeats_, readings_)
            .rightCols(1)
            .squaredNorm();
    }

    /// Lengths of the whitened residuals, of one target seen after another, to the front of
    /// `lengths`; returns how many they are.
    Index measure(Index i, const Parameters& parameters, const Parameters& of_noise,
                  Eigen::Ref<VectorXd> lengths) {
        go_to(i);
        place_flange(parameters);
        const bool is_elsewhere = &of_noise != &parameters;
        residual_ = deviate(i, parameters);
        if (is_elsewhere) place_flange(of_noise);
        const Index rows = noise_.whiten_seen(motion_, of_noise.sensor, repeats_, residual_);
        Index count = 0;
        for (Index row = 0; row < rows; ++count) {
            const Index width = width_of_seen(row);
            lengths[count] = residual_.middleRows(row, width).norm();
            row += width;
        }
        return count;
    }

  private:
    /// Adds the residual to `all`, whitens both and weighs them; returns how many rows are seen.
    Index finish(Index i, const Parameters& parameters, Eigen::Ref<RowMatrixXd> all) {
        all.rightCols(1) = deviate(i, parameters);
        const Index rows = noise_.whiten_seen(motion_, parameters.sensor, repeats_, all);
        if (problem_.loss.kind == LossKind::Squares) return rows;
        for (Index row = 0; row < rows;) {
            const Index width = width_of_seen(row);
            auto of_target = all.middleRows(row, width);
            const double length = of_target.rightCols(1).norm();
            of_target *= std::sqrt(problem_.loss.weight(length / problem_.deviation));
            row += width;
        }
        return rows;
    }

    void go_to(Index i) {
        q_ = problem_.means.configurations.row(i).transpose();
        repeats_ = problem_.repeats.row(i).transpose();
    }

    /// Rows of the target that begins at this row of those seen.
    Index width_of_seen(Index row) const {
        return sensor_.rows_of(sensor_.target_of(noise_.rows()[static_cast<std::size_t>(row)]));
    }

    /// Of the flange's motion what the noise needs.
    void place_flange(const Parameters& parameters) {
        const Campaign& campaign = problem_.campaign;
        if (campaign.joint_repeatability.size() > 0) {
            differentiate_flange(campaign, parameters, q_, motion_);
        } else {
            motion_.world_from_flange = world_from_flange(campaign, parameters, q_);
        }
    }

    /// Of what was observed from what is predicted where the flange is.
    const VectorXd& deviate(Index i, const Parameters& parameters) {
        sensor_.predict(motion_.world_from_flange, parameters.sensor, predicted_);
        sensor_.deviation(problem_.means.observations.row(i).transpose(), predicted_, deviation_);
        return deviation_;
    }

    const IdentificationProblem& problem_;
    const Sensor& sensor_;
    PoseNoise noise_;
    FlangeMotion motion_;
    VectorXd q_;
    VectorXd repeats_;
    VectorXd predicted_;
    VectorXd deviation_;
    RowMatrixXd residual_;
    RowMatrixXd readings_;  // A, then r
};

}  // namespace

bool pays_narrowly(const Sensor& sensor, const Parameters& parameters) {
    const bool is_wide = sensor.row_count() >= 2 * narrow_width(parameters);
    return is_wide && !(sensor.has_lengths() && sensor.has_angles());
}

std::string describe_unseen_target(const Campaign& campaign, const Measurements& measurements) {
    if (campaign.prior && campaign.prior->has_sensor) return "";
    const Sensor& sensor = *campaign.sensor;
    const Targets& targets = sensor.targets();
    std::vector<bool> is_seen(static_cast<std::size_t>(targets.count()), false);
    for (Index k = 0; k < sensor.target_count(); ++k) {
        if (!measurements.is_seen.col(k).any()) continue;
        is_seen[static_cast<std::size_t>(sensor.point_of(k))] = true;
    }
    for (Index j = 0; j < targets.count(); ++j) {
        if (targets.is_known(j) || is_seen[static_cast<std::size_t>(j)]) continue;
        return fmt::format(
            "target {} is seen in no sample of {}, so its position cannot be found; measure it, or "
            "leave it out of the campaign's targets",
            j + 1, these(measurements.configuration_count(), "configuration"));
    }
    if (sensor.needs_first_guess()) return "";
    const std::vector<std::string> contacts = sensor.contact_names();
    for (Index k = 0; k < std::ssize(contacts); ++k) {
        if (measurements.is_seen.col(k).any()) continue;
        return fmt::format(
            "{} is not touched in {}, so its place cannot be found; touch it, or leave it out "
            "of the campaign's sockets",
            quote(contacts[static_cast<std::size_t>(k)]),
            these(measurements.configuration_count(), "configuration"));
    }
    return "";
}

IdentificationProblem make_problem(const Campaign& campaign, const Measurements& measurements) {
    check_noise(campaign);
    check_size(campaign, measurements);
    return {campaign, measurements, mean_measurements(*campaign.sensor, measurements),
            times_seen(measurements), ParameterUnits(campaign)};
}

std::string describe_missing_equations(const IdentificationProblem& problem) {
    std::string unseen = describe_unseen_target(problem.campaign, problem.measurements);
    if (!unseen.empty() || problem.equation_count() >= problem.units.size()) return unseen;
    const Index count = problem.means.configuration_count();
    return fmt::format("{} {} {}, {} parameters need at least as many",
                       count_of(count, "configuration"), count == 1 ? "gives" : "give",
                       count_of(problem.equation_count(), "equation"), problem.units.size());
}

LinearisedSystem linearise(const IdentificationProblem& problem, const Parameters& parameters,
                           Equations equations) {
    const Campaign& campaign = problem.campaign;
    const Index size = problem.units.size();
    const bool is_narrow =
        equations == Equations::Fewest && pays_narrowly(*campaign.sensor, parameters);
    const Index width = is_narrow ? narrow_width(parameters) : campaign.sensor->row_count();
    Configurations configurations(problem);
    const Index most = std::min(problem.observation_count(), width * configurations.count());
    const Index count = problem.prior_count();
    LinearisedSystem system{RowMatrixXd(most + count, size + 1)};
    system.first_row.reserve(static_cast<std::size_t>(configurations.count()) + 1);
    RowMatrixXd of_configuration(width, size + 1);
    Index row = 0;
    for (Index i = 0; i < configurations.count(); ++i) {
        const Index rows = is_narrow
                               ? configurations.state_narrowly(i, parameters, of_configuration)
                               : configurations.state(i, parameters, of_configuration);
        system.augmented.middleRows(row, rows) = of_configuration.topRows(rows);
        row += rows;
        system.first_row.push_back(row);
    }
    problem.units.scale_columns(system.augmented.topLeftCorner(row, size));
    system.augmented.conservativeResize(row + count, Eigen::NoChange);
    if (count > 0) {
        auto prior = system.augmented.bottomRows(count);
        prior.setZero();
        prior.middleCols(problem.prior_begin(), count) =
            problem.units.prior_derivative(campaign, parameters);
        prior.col(size) = -problem.units.prior_coordinates(campaign, parameters);
    }
    return system;
}

RowMatrixXd whitened_columns(const IdentificationProblem& problem, const Parameters& parameters,
                             Index count, const FillColumns& fill) {
    RowMatrixXd columns(problem.observation_count(), count);
    RowMatrixXd of_configuration(problem.campaign.sensor->row_count(), count + 1);
    Configurations configurations(problem);
    Index row = 0;
    for (Index i = 0; i < configurations.count(); ++i) {
        const Index rows = configurations.state_columns(i, parameters, fill, of_configuration);
        columns.middleRows(row, rows) = of_configuration.topLeftCorner(rows, count);
        row += rows;
    }
    return columns;
}

VectorXd residual_lengths(const IdentificationProblem& problem, const Parameters& parameters,
                          const Parameters* noise_at) {
    const Parameters& of_noise = noise_at != nullptr ? *noise_at : parameters;
    VectorXd lengths(problem.means.is_seen.count());
    Configurations configurations(problem);
    Index count = 0;
    for (Index i = 0; i < configurations.count(); ++i) {
        count +=
            configurations.measure(i, parameters, of_noise, lengths.tail(lengths.size() - count));
    }
    return lengths;
}

double total_loss(const IdentificationProblem& problem, const Parameters& parameters,
                  const Parameters* noise_at) {
    double sum = 0;
    if (problem.loss.kind == LossKind::Squares &&
        pays_narrowly(*problem.campaign.sensor, parameters)) {
        Configurations configurations(problem);
        for (Index i = 0; i < configurations.count(); ++i) {
            sum +=
                configurations.square(i, parameters, noise_at != nullptr ? *noise_at : parameters);
        }
    } else {
        for (const double length : residual_lengths(problem, parameters, noise_at)) {
            sum += problem.loss.value(length / problem.deviation);
        }
        sum *= problem.deviation * problem.deviation;
    }
    if (problem.prior_count() > 0) {
        sum += problem.units.prior_coordinates(problem.campaign, parameters).squaredNorm();
    }
    return sum;
}

double converged_below(const IdentificationProblem& problem, double relative_tolerance,
                       double cost) {
    constexpr double negligible_per_equation = 1e-20;
    constexpr double negligible_beside_prior = 1e-6;
    if (problem.campaign.prior) return negligible_beside_prior;
    return negligible_per_equation * static_cast<double>(problem.equation_count()) +
           relative_tolerance * cost;
}

Triangle triangularise(const LinearisedSystem& system) {
    const Index size = system.J().cols();
    const MatrixXd R = triangular_factor(system.augmented);
    return {R.topLeftCorner(size, size), R.col(size).head(size), system.r().squaredNorm()};
}

MatrixXd invert_triangle(const MatrixXd& R) {
    return R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(R.cols(), R.cols()));
}

std::vector<Index> confused_parameters(const IdentificationProblem& problem,
                                       const Parameters& parameters) {
    Parameters nominal = parameters;
    nominal.robot.setZero();
    const LinearisedSystem system = linearise(problem, nominal);
    if (system.J().cols() == 0) return {};  // a registration where base and sensor are known
    // Mostly it is far from that, which is told more quickly.
    if (Metric(normal_equations(problem, system).M).is_regular()) return {};
    MatrixXd R = triangularise(system).R;
    const VectorXd norms = R.colwise().norm().transpose().cwiseMax(1e-300);
    R.array().rowwise() /= norms.transpose().array();
    // Unit columns: s1 <= sqrt(L). And sL >= 1 / |R^-1|, mostly enough, without singular values.
    const double least = 1e-9 * std::sqrt(static_cast<double>(R.cols()));
    if (invert_triangle(R).norm() * least < 1) return {};
    const WeakDirection weakest = weakest_directions(R, 1).front();
    std::vector<Index> confused;
    if (weakest.singular_value > least) return confused;
    for (const ParameterTerm& term : weakest.terms) {
        if (std::abs(term.coefficient) >= 1e-6) confused.push_back(term.parameter);
    }
    return confused;
}

std::string name_parameters(const Campaign& campaign, const std::vector<Index>& parameters) {
    const auto names = parameter_names(campaign);
    std::string words;
    for (const Index k : parameters) {
        words += (words.empty() ? "" : ", ") + names[static_cast<std::size_t>(k)];
    }
    return words;
}

std::string describe_undetermined(const IdentificationProblem& problem,
                                  const Parameters& parameters) {
    std::string missing = describe_missing_equations(problem);
    if (!missing.empty()) return missing;
    const std::vector<Index> confused = confused_parameters(problem, parameters);
    if (confused.empty()) return "";
    const Campaign& campaign = problem.campaign;
    const Index robot_begin = base_parameter_count(campaign);
    const auto of_robot = std::count_if(confused.begin(), confused.end(), [&](Index k) {
        return k >= robot_begin && k < robot_begin + campaign.robot.parameter_count();
    });
    std::vector<std::string> advice{"measure more or more different configurations"};
    if (of_robot > 0) advice.emplace_back("leave one of these parameters out");
    if (of_robot < std::ssize(confused)) {
        advice.push_back("state which of them are known: " +
                         list_words(campaign.sensor->words().known));
    }
    return fmt::format("{} cannot tell apart the effects of: {}; {}",
                       these(problem.means.configuration_count(), "configuration"),
                       name_parameters(campaign, confused), list_words(advice));
}

Estimate begin_estimate(const IdentificationProblem& problem, const Parameters& start) {
    Estimate estimate;
    estimate.parameters = start;
    estimate.undetermined = describe_undetermined(problem, start);
    if (!estimate.undetermined.empty()) estimate.ending = Ending::NotIdentifiable;
    return estimate;
}

void finish(const IdentificationProblem& problem, const LinearisedSystem& system,
            Estimate& estimate) {
    const Triangle at_estimate = triangularise(system);
    const MatrixXd& R = at_estimate.R;
    estimate.degrees_of_freedom = problem.equation_count() - R.cols();
    const bool is_robust = problem.loss.kind != LossKind::Squares;
    estimate.variance_factor =
        is_robust ? problem.deviation * problem.deviation
        : estimate.degrees_of_freedom > 0
            ? at_estimate.squares / static_cast<double>(estimate.degrees_of_freedom)
            : 1.0;
    if (is_robust) {
        estimate.covariance = robust_covariance(problem, estimate.parameters, R);
    } else {
        const MatrixXd root = invert_triangle(R);
        estimate.covariance = find_variances(problem, system, root, estimate);
    }
    problem.units.unscale(estimate.covariance);
    estimate.names = parameter_names(problem.campaign);
    estimate.model_error = problem.campaign.model_error;
    estimate.model_error_orientation = problem.campaign.model_error_orientation;
    estimate.model_error_within = problem.campaign.known_within.model_error;
    estimate.loss = problem.loss;
    if (is_robust) estimate.outliers = find_outliers(problem, estimate.parameters);
    estimate.fit = make_metrics(problem.campaign, estimate.parameters, problem.measurements);
    estimate.fit_means = make_metrics(problem.campaign, estimate.parameters, problem.means);
}

}  // namespace posewise::detail
