#include "posewise/criteria/criterion.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "posewise/core/errors.hpp"
#include "posewise/core/text.hpp"
#include "posewise/criteria/objective.hpp"

namespace posewise {
namespace {

struct CriterionName {
    Criterion criterion;
    std::string_view name;
};
constexpr std::array<CriterionName, 10> names{{{Criterion::O1, "o1"},
                                               {Criterion::O2, "o2"},
                                               {Criterion::O3, "o3"},
                                               {Criterion::O4, "o4"},
                                               {Criterion::O5, "o5"},
                                               {Criterion::A, "a"},
                                               {Criterion::D, "d"},
                                               {Criterion::E, "e"},
                                               {Criterion::G, "g"},
                                               {Criterion::V, "v"}}};

}  // namespace

std::string_view criterion_name(Criterion criterion) {
    return std::find_if(names.begin(), names.end(),
                        [&](const auto& entry) { return entry.criterion == criterion; })
        ->name;
}

Criterion parse_criterion(std::string_view name) {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (lower == "i") return Criterion::V;
    std::string all;
    for (const auto& entry : names) {
        if (entry.name == lower) return entry.criterion;
        all += (all.empty() ? "" : ", ") + std::string(entry.name);
    }
    throw InputError(quote(name) + " is no criterion; must be one of " + all +
                     " (or i, the same as v)");
}

VectorXd singular_values(const RowMatrixXd& stacked) {
    if (!stacked.allFinite()) {
        throw InputError("stacked blocks have a value that is not a finite number");
    }
    VectorXd values = VectorXd::Zero(stacked.cols());
    const Index count = std::min(stacked.rows(), stacked.cols());
    if (count == 0) return values;
    MatrixXd R = stacked;
    if (stacked.rows() > stacked.cols()) {
        const Eigen::HouseholderQR<MatrixXd> qr(stacked);
        R = qr.matrixQR().topRows(count).triangularView<Eigen::Upper>();
    }
    values.head(count) = Eigen::JacobiSVD<MatrixXd>(R).singularValues();
    return values;
}

double evaluate(Criterion criterion, const VectorXd& singular_values, Index pose_count) {
    if (criterion == Criterion::G || criterion == Criterion::V) {
        throw InputError("criterion " + std::string(criterion_name(criterion)) +
                         " needs test poses, singular values are not enough");
    }
    if (pose_count < 1) {
        throw InputError("pose count is " + std::to_string(pose_count) + ", must be at least 1");
    }
    const auto s = singular_values.array();
    if (s.size() == 0) return -std::numeric_limits<double>::infinity();
    const double largest = s[0];
    const double least = s[s.size() - 1];
    if (!s.isFinite().all() || !(least > 1e-12 * largest)) {
        return -std::numeric_limits<double>::infinity();
    }
    switch (criterion) {
        case Criterion::O1:
            return std::exp(s.log().mean()) / std::sqrt(static_cast<double>(pose_count));
        case Criterion::O2:
            return least / largest;
        case Criterion::O3:
            return least;
        case Criterion::O4:
            return least * (least / largest);
        case Criterion::O5:
            return 1 / s.inverse().sum();
        case Criterion::A:
            return 1 / s.inverse().square().sum();
        case Criterion::E:
            return least * least;
        default:
            return 2 * s.log().sum();
    }
}

double evaluate(Criterion criterion, const MatrixXd& M, Index pose_count,
                const Blocks* test_poses) {
    return evaluate(make_objective(criterion, pose_count, test_poses), M);
}

}  // namespace posewise
