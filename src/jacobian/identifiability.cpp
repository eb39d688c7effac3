#include "posewise/jacobian/identifiability.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "../core/decompositions.hpp"
#include "../measurement/contact.hpp"
#include "../model/complete_model.hpp"
#include "../model/sampling.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

constexpr std::uint64_t configuration_seed = 20151;  // any: it only has to be the same every time

/// A column below this share of the largest is rounding: the parameter moves nothing.
constexpr double negligible_share = 1e-12;

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

MatrixXd stack_at_nominal(const Campaign& campaign, Index pose_count) {
    Parameters nominal = campaign.nominal;
    nominal.robot.setZero(campaign.robot.parameter_count());  // beside it rank is nearly lost only
    const detail::ShownPoses poses =
        detail::random_poses(campaign, nominal, pose_count, configuration_seed);
    return make_plain_blocks(campaign, nominal, poses.configurations, times_seen(poses.is_seen, 1))
        .matrix;
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

}  // namespace

Identifiability find_independent_columns(const MatrixXd& J, const std::vector<Index>& priority,
                                         double tolerance) {
    const double largest = J.colwise().norm().maxCoeff();
    Identifiability result;
    MatrixXd Q(J.rows(), std::min(J.rows(), J.cols()));
    Index rank = 0;
    std::vector<Index> open = priority;
    for (double least = std::max(1e-2, tolerance);; least = std::max(1e-2 * least, tolerance)) {
        std::vector<Index> rest;
        result.largest_dropped_residual = 0;
        for (const Index k : open) {
            const double norm = J.col(k).norm();
            const VectorXd residual = norm > negligible_share * largest
                                          ? residual_outside(Q.leftCols(rank), J.col(k) / norm)
                                          : VectorXd::Zero(J.rows());
            const double residual_norm = residual.norm();
            if (residual_norm > least && rank < Q.cols()) {
                Q.col(rank++) = residual / residual_norm;
                result.kept.push_back(k);
                result.least_kept_residual = std::min(result.least_kept_residual, residual_norm);
            } else {
                rest.push_back(k);
                result.largest_dropped_residual =
                    std::max(result.largest_dropped_residual, residual_norm);
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
        const double norm = J.col(result.dropped[d].parameter).norm();
        if (norm <= negligible_share * largest) continue;
        for (std::size_t k = 0; k < result.kept.size(); ++k) {
            const double coefficient = combination(static_cast<Index>(k), static_cast<Index>(d));
            // What is less than 1e-7 of the dropped column is rounding.
            if (std::abs(coefficient) * J.col(result.kept[k]).norm() > 1e-7 * norm) {
                result.dropped[d].absorbed_by.push_back({result.kept[k], coefficient});
            }
        }
    }
    return result;
}

Identifiability find_identifiable(const Campaign& campaign) {
    return find_independent_columns(stack_at_nominal(campaign, 2 * parameter_count(campaign)),
                                    make_priority(campaign));
}

bool has_clear_gap(const Identifiability& found) {
    return found.least_kept_residual >= 1e3 * found.largest_dropped_residual;
}

std::vector<Index> weakest_kept(const Campaign& campaign, const Identifiability& found,
                                Index count) {
    const MatrixXd J = stack_at_nominal(campaign, 2 * parameter_count(campaign));
    MatrixXd kept = J(Eigen::all, found.kept);
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

Chain without_errors_of_base(const Chain& chain) {
    constexpr double rounding = 1e-9;  // of twists, rad per rad and m per rad
    const RowMatrixXd drawn = detail::random_configurations(chain, 2, configuration_seed);
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

Chain irreducible_model(const Campaign& campaign) {
    const Campaign complete = with_robot(campaign, detail::complete_model(campaign.robot));
    const auto names = parameter_names(complete);
    std::vector<std::string> kept;
    for (const Index k : find_identifiable(complete).kept) {
        kept.push_back(names[static_cast<std::size_t>(k)]);
    }
    return keep_parameters(complete.robot, kept);
}

Index least_pose_count(const Campaign& stated) {
    // What has a prior needs no pose.
    const Campaign campaign =
        stated.spread.is_prior ? with_robot(stated, without_parameters(stated.robot)) : stated;
    const Identifiability all = find_identifiable(campaign);
    const auto rank = static_cast<Index>(all.kept.size());
    const Index rows = campaign.sensor->rows_per_target() * campaign.sensor->seen_at_once();
    const MatrixXd J = stack_at_nominal(campaign, 2 * parameter_count(campaign));
    const auto suffices = [&](Index count) {
        if (count * rows >= J.rows()) return true;
        const auto some = find_independent_columns(J.topRows(count * rows), all.kept);
        return static_cast<Index>(some.kept.size()) == rank;
    };
    Index least = (rank + rows - 1) / rows;  // nothing less can
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
    const MatrixXd R = stacked.rows() > size ? detail::triangular_factor(stacked) : stacked;
    const Eigen::JacobiSVD<MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(
        R, Eigen::ComputeFullU | Eigen::ComputeFullV);
    std::vector<WeakDirection> directions;
    for (Index i = size - 1; i >= 0 && static_cast<Index>(directions.size()) < count; --i) {
        WeakDirection direction;
        if (i < svd.singularValues().size()) direction.singular_value = svd.singularValues()[i];
        for (Index k = 0; k < size; ++k) direction.terms.push_back({k, svd.matrixV()(k, i)});
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
