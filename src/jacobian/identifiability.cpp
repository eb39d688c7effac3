#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/decompositions.hpp"
#include "core/text.hpp"
#include "model/complete_model.hpp"
#include "model/error_class.hpp"
#include "model/sampling.hpp"
#include "nominal_factor.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

/// The part of `column` outside the span of the orthonormal columns of Q; twice, so that rounding
/// of the first pass is gone.
VectorXd residual_outside(const Eigen::Ref<const MatrixXd>& Q, VectorXd column) {
    for (int pass = 0; pass < 2; ++pass) column -= Q * (Q.transpose() * column);
    return column;
}

/// Base and sensor first, then joint offsets, translations, other rotations, terms: what comes
/// early is kept, so a link error is dropped in favour of an offset, a base or a target it equals.
std::vector<Index> make_priority(const Campaign& campaign) {
    const Index begin = base_parameter_count(campaign);
    const Index end = begin + campaign.robot.parameter_count();
    const auto rank = [&](Index k) {
        if (k < begin || k >= end) return 0;
        if (campaign.robot.parameter_term(k - begin) != nullptr) return 4;
        const Element& element = campaign.robot.parameter_element(k - begin);
        if (!element.joints.empty()) return 1;
        return element.motion == Motion::Translation ? 2 : 3;
    };
    std::vector<Index> priority(static_cast<std::size_t>(parameter_count(campaign)));
    std::iota(priority.begin(), priority.end(), Index{0});
    std::stable_sort(priority.begin(), priority.end(),
                     [&](Index a, Index b) { return rank(a) < rank(b); });
    return priority;
}

/// How the dropped columns follow from the kept ones: kept x dropped, in the columns' own units.
MatrixXd express_dropped(const MatrixXd& J, const Identifiability& result) {
    MatrixXd kept(J.rows(), static_cast<Index>(result.kept.size()));
    for (Index i = 0; i < kept.cols(); ++i) {
        kept.col(i) = J.col(result.kept[static_cast<std::size_t>(i)]);
    }
    MatrixXd dropped(J.rows(), static_cast<Index>(result.dropped.size()));
    for (Index i = 0; i < dropped.cols(); ++i) {
        dropped.col(i) = J.col(result.dropped[static_cast<std::size_t>(i)].parameter);
    }
    const VectorXd norms = kept.colwise().norm().transpose();
    kept.array().rowwise() /= norms.transpose().array();
    const MatrixXd combination = detail::solve_least_squares(std::move(kept), dropped);
    return norms.cwiseInverse().asDiagonal() * combination;
}

/// What was meant by `unknown`: an error of the robot, or a class of those that it has.
std::string suggest_error(const std::string& unknown, const std::vector<std::string>& names,
                          std::vector<std::string> classes) {
    std::sort(classes.begin(), classes.end());
    classes.erase(std::unique(classes.begin(), classes.end()), classes.end());
    for (const std::string& one : classes) {
        if (one == "class:" + unknown) return detail::suggest(one, {one});
    }
    if (unknown.starts_with("class:")) {
        classes.insert(classes.begin(), "one of its errors");
        return "must be " + detail::list_words(classes);
    }
    classes.insert(classes.begin(), names.begin(), names.end());
    return detail::suggest(unknown, classes);
}

}  // namespace

Identifiability find_independent_columns(const MatrixXd& J, const std::vector<Index>& priority,
                                         double tolerance, const StopSignal& stop,
                                         const VectorXd& least_shares) {
    const double largest = J.colwise().norm().maxCoeff();
    const auto least_share = [&](Index k) {
        return least_shares.size() > 0 ? least_shares[k] : 1e-12;
    };
    Identifiability result;
    MatrixXd Q(J.rows(), std::min(J.rows(), J.cols()));
    Index rank = 0;
    constexpr Index quick = 100;  // columns, that take no time
    std::vector<Index> open = priority;
    for (double least = std::max(1e-2, tolerance);; least = std::max(1e-2 * least, tolerance)) {
        std::vector<Index> rest;
        result.largest_dropped_residual = 0;
        for (const Index k : open) {
            if (rank >= quick) stop.check(fmt::format("telling {} parameters apart", J.cols()));
            const double norm = J.col(k).norm();
            const VectorXd residual = norm > least_share(k) * largest
                                          ? residual_outside(Q.leftCols(rank), J.col(k) / norm)
                                          : VectorXd::Zero(J.rows());
            const double residual_norm = residual.norm();
            const double share = residual_norm * norm / largest;
            if (residual_norm > least && share > least_share(k) && rank < Q.cols()) {
                Q.col(rank++) = residual / residual_norm;
                result.kept.push_back(k);
                result.least_kept_residual = std::min(result.least_kept_residual, residual_norm);
            } else {
                rest.push_back(k);
                // What depends on others, or is too little of what is strongest.
                const double dropped = residual_norm > least ? share : residual_norm;
                result.largest_dropped_residual =
                    std::max(result.largest_dropped_residual, dropped);
            }
        }
        open = std::move(rest);
        if (least <= tolerance) break;
    }
    for (const Index k : open) result.dropped.push_back({k, {}});
    std::sort(result.kept.begin(), result.kept.end());
    if (result.dropped.empty() || result.kept.empty()) return result;

    const MatrixXd combination = express_dropped(J, result);
    for (std::size_t d = 0; d < result.dropped.size(); ++d) {
        const Index parameter = result.dropped[d].parameter;
        const double norm = J.col(parameter).norm();
        if (norm <= least_share(parameter) * largest) continue;
        for (std::size_t k = 0; k < result.kept.size(); ++k) {
            const double coefficient = combination(static_cast<Index>(k), static_cast<Index>(d));
            // What is less of the dropped column is rounding.
            const double part = std::abs(coefficient) * J.col(result.kept[k]).norm();
            if (part > std::max(1e-7, least_share(parameter)) * norm) {
                result.dropped[d].absorbed_by.push_back({result.kept[k], coefficient});
            }
        }
    }
    return result;
}

Identifiability find_identifiable(const Campaign& campaign, const StopSignal& stop) {
    Identifiability found =
        find_independent_columns(detail::factor_at_nominal(campaign, stop), make_priority(campaign),
                                 least_residual, stop, detail::least_shares_of(campaign));
    const VectorXd sizes = detail::sizes_of(campaign);
    for (DroppedParameter& dropped : found.dropped) {
        for (ParameterTerm& term : dropped.absorbed_by) {
            term.coefficient *= sizes[term.parameter] / sizes[dropped.parameter];
        }
    }
    return found;
}

bool has_clear_gap(const Identifiability& found) {
    return found.least_kept_residual >= 1e3 * found.largest_dropped_residual;
}

std::vector<Index> weakest_kept(const Campaign& campaign, const Identifiability& found,
                                Index count) {
    MatrixXd kept = detail::factor_at_nominal(campaign, {})(Eigen::all, found.kept);
    kept.colwise().normalize();
    std::vector<Index> parameters;
    const std::vector<WeakDirection> weakest = weakest_directions(kept, 1, count);
    for (const ParameterTerm& term : weakest.front().terms) {
        parameters.push_back(found.kept[static_cast<std::size_t>(term.parameter)]);
    }
    return parameters;
}

Chain keep_parameters(const Chain& chain, const std::vector<std::string>& names) {
    const auto is_dropped = [&names](const std::string& name) {
        return std::find(names.begin(), names.end(), name) == names.end();
    };
    std::vector<Element> elements;
    for (Element element : chain.elements()) {
        if (is_dropped(element.parameter)) element.parameter.clear();
        std::erase_if(element.terms, [&](const ErrorTerm& t) { return is_dropped(t.parameter); });
        // An element that was there only for its error is gone with it.
        const bool empty = element.value == 0 && element.joints.empty() &&
                           element.parameter.empty() && element.terms.empty();
        if (!empty) elements.push_back(std::move(element));
    }
    return chain.with_elements(std::move(elements));
}

Campaign with_free_errors(const Campaign& campaign, const std::vector<std::string>& errors) {
    const auto names = campaign.robot.parameter_names();
    std::vector<std::string> classes;  // of each error
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        classes.emplace_back("class:").append(
            detail::name_of(detail::error_class_names, detail::error_class_of(campaign.robot, k)));
    }
    std::vector<std::string> kept;
    for (const std::string& error : errors) {
        const std::size_t before = kept.size();
        for (std::size_t k = 0; k < names.size(); ++k) {
            if (names[k] == error || classes[k] == error) kept.push_back(names[k]);
        }
        if (kept.size() == before) {
            throw InputError(fmt::format("{} is no error of the robot; {}", detail::quote(error),
                                         suggest_error(error, names, classes)));
        }
    }
    return with_robot(campaign, keep_parameters(campaign.robot, kept));
}

Chain without_errors_of_base(const Chain& chain) {
    constexpr double rounding = 1e-9;  // of twists, rad per rad and m per rad
    const RowMatrixXd drawn = detail::random_configurations(chain, 2, detail::configuration_seed);
    std::array<FlangeMotion, 2> motions;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        chain.differentiate(Isometry3d::Identity(), drawn.row(static_cast<Index>(i)).transpose(),
                            VectorXd::Zero(chain.parameter_count()), motions[i]);
    }
    const std::vector<std::string> names = chain.parameter_names();
    std::vector<std::string> kept;
    for (Index k = 0; k < chain.parameter_count(); ++k) {
        const Index column = 6 + k;
        const Twist change = motions[1].twists.col(column) - motions[0].twists.col(column);
        if (change.norm() > rounding || chain.parameter_term(k) != nullptr) {
            kept.push_back(names[static_cast<std::size_t>(k)]);
        }
    }
    return keep_parameters(chain, kept);
}

namespace {

/// The robot with those of its error parameters alone that can be told apart.
Chain reduce(const Campaign& campaign, const StopSignal& stop) {
    const auto names = parameter_names(campaign);
    std::vector<std::string> kept;
    for (const Index k : find_identifiable(campaign, stop).kept) {
        kept.push_back(names[static_cast<std::size_t>(k)]);
    }
    return keep_parameters(campaign.robot, kept);
}

}  // namespace

Chain irreducible_model(const Campaign& campaign, const StopSignal& stop) {
    return reduce(with_robot(campaign, detail::complete_model(campaign.robot)), stop);
}

Chain irreducible_offsets(const Campaign& campaign, const StopSignal& stop) {
    const Chain complete = detail::complete_model(campaign.robot);
    const auto names = complete.parameter_names();
    std::vector<std::string> offsets;
    for (Index k = 0; k < complete.parameter_count(); ++k) {
        if (complete.parameter_term(k) == nullptr && complete.parameter_element(k).joints.empty()) {
            continue;
        }
        offsets.push_back(names[static_cast<std::size_t>(k)]);
    }
    return reduce(with_robot(campaign, keep_parameters(complete, offsets)), stop);
}

Index least_pose_count(const Campaign& stated, const StopSignal& stop) {
    // What has a prior needs no pose.
    const Campaign campaign =
        stated.spread.is_prior ? with_robot(stated, without_parameters(stated.robot)) : stated;
    const Identifiability all = find_identifiable(campaign, stop);
    const auto rank = static_cast<Index>(all.kept.size());
    const detail::ShownPoses poses = detail::poses_to_judge(campaign);
    Index rows = 1;  // of a pose, the most
    for (Index i = 0; i < poses.is_seen.rows(); ++i) {
        rows = std::max(rows, seen_row_count(*campaign.sensor, poses.is_seen.row(i)));
    }
    const VectorXd sizes = detail::sizes_of(campaign);
    const auto suffices = [&](Index count) {
        if (count >= poses.configurations.rows()) return true;
        const MatrixXd J = detail::stack_at_nominal(campaign, poses, 0, count) * sizes.asDiagonal();
        const auto some = find_independent_columns(J, all.kept, least_residual, stop,
                                                   detail::least_shares_of(campaign));
        return static_cast<Index>(some.kept.size()) == rank;
    };
    const Index told = campaign.sensor->unknown_sizes().size();
    Index least = (rank - told + rows - 1) / rows;  // nothing less can
    Index enough = least;
    for (Index step = 1; !suffices(enough); step *= 2) {
        least = enough + 1;
        enough += step;
    }
    while (least < enough) {
        const Index middle = (least + enough) / 2;
        if (suffices(middle)) {
            enough = middle;
        } else {
            least = middle + 1;
        }
    }
    return least;
}

std::vector<WeakDirection> weakest_directions(const MatrixXd& stacked, Index count,
                                              Index terms_each) {
    const Index size = stacked.cols();
    const auto [values, V] = detail::singular_directions(stacked);
    std::vector<WeakDirection> directions;
    for (Index i = size - 1; i >= 0 && static_cast<Index>(directions.size()) < count; --i) {
        WeakDirection direction;
        if (i < stacked.rows()) direction.singular_value = values[i];
        for (Index k = 0; k < size; ++k) direction.terms.push_back({k, V(k, i)});
        std::stable_sort(direction.terms.begin(), direction.terms.end(),
                         [](const ParameterTerm& a, const ParameterTerm& b) {
                             return std::abs(a.coefficient) > std::abs(b.coefficient);
                         });
        direction.terms.resize(static_cast<std::size_t>(std::min(terms_each, size)));
        if (direction.terms.front().coefficient < 0) {
            for (ParameterTerm& term : direction.terms) term.coefficient = -term.coefficient;
        }
        directions.push_back(std::move(direction));
    }
    return directions;
}

}  // namespace posewise
