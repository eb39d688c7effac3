#pragma once

#include "neighbourhood.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {

/// How good a choice is: first whether it identifies the parameters, then the objective, of the
/// regularised information matrix if it does not. While a search goes on both are by information
/// matrices, which is quick; judge() is by the rows.
struct SearchScore {
    bool identifies = false;
    double value = -std::numeric_limits<double>::infinity();
};
/// Whether `a` is better than `b` beyond rounding.
bool is_better(const SearchScore& a, const SearchScore& b);

/// What all starts of one selection share.
struct SearchProblem {
    const Blocks& candidates;
    const SelectOptions& options;
    const Objective& objective;
    MatrixXd held;
    double ridge = 0;       ///< times the identity: small, but makes every matrix positive definite
    Index common_rows = 0;  ///< of all candidates, split off: among what is held
    /// From 1 to 10: choices with hardly more rows than parameters to tell have many local optima.
    double ruggedness = 10;

    MatrixXd regularised_information(const std::vector<Index>& poses) const;
    SearchScore score(const MatrixXd& regularised) const;
};

/// A choice of candidates in the search, and how good it is.
struct ScoredPoses {
    std::vector<Index> poses;
    SearchScore score;
};

/// The same poses, ascending, scored by choice_value(): what is compared at the end, with what is
/// stated.
ScoredPoses judge(const SearchProblem& problem, ScoredPoses choice);

/// Of a SearchProblem: far below what candidates tell.
double ridge_of(const Blocks& candidates);

double mean_rows(const Blocks& candidates);
/// On average, with those that were split off.
double rows_each(const SearchProblem& problem);

/// Of a SearchProblem, by the parameters that poses like those of the shortlist tell beyond what is
/// held: tr((H + M)^-1 M), all without a prior.
double ruggedness(const SearchProblem& problem, const Shortlist& shortlist);

/// K poses in the given order, as the limits allow; rounds repeat it for repeated poses. Fewer
/// where the limits leave no more.
std::vector<Index> take_in_order(const SearchProblem& problem, const std::vector<Index>& order);

/// Exchanges each pose for the best of the shortlist, in turn, until no exchange improves.
ScoredPoses improve(const SearchProblem& problem, const Shortlist& shortlist,
                    const ScoredPoses& choice);

/// Whether gains are exact and the shortlist is long: searches then exchange with the candidates
/// nearest() first.
bool has_far(const SearchProblem& problem, const Shortlist& shortlist);
/// The shortlist of those candidates that come nearest to improving the choice.
Shortlist nearest(const SearchProblem& problem, const Shortlist& shortlist,
                  const ScoredPoses& choice);

/// Iterated local search: some poses of the best choice are replaced at random and the result
/// improved, until `options.kicks` kicks in a row, times the ruggedness, bring nothing. Where the
/// shortlist has_far(), what is kicked is improved with the candidates nearest() the best, and with
/// the whole shortlist only where that is better.
ScoredPoses improve_with_kicks(const SearchProblem& problem, const Shortlist& shortlist,
                               const ScoredPoses& choice, RandomStream& random);

}  // namespace posewise::detail
