#pragma once

#include "posewise/selection/choice.hpp"

namespace posewise::detail {

/// How often each candidate may be chosen: 0 if excluded, else the repeat limit.
std::vector<Index> capacities(Index candidate_count, const SelectOptions& options);

/// How often each candidate is taken in the choice of K with the largest sum of values, under
/// capacities and group limits (distances are left out, so this is the top of every choice
/// allowed). The lower index first among equals. Only taken candidates are listed.
struct Taken {
    Index candidate = 0;
    Index count = 0;
};
std::vector<Taken> most_valuable(const VectorXd& values, const SelectOptions& options);

/// A choice of poses as the limits see it: which candidates may join it.
class Occupancy {
  public:
    Occupancy(Index candidate_count, const SelectOptions& options);

    void add(Index candidate) { count(candidate, 1); }
    void remove(Index candidate) { count(candidate, -1); }
    /// Whether one more of this candidate is allowed.
    bool allows(Index candidate) const;

  private:
    void count(Index candidate, Index change);

    const SelectOptions* options_;
    std::vector<Index> free_;        // how often each candidate may still be chosen
    std::vector<Index> neighbours_;  // other chosen poses too near to each candidate
    std::vector<Index> group_free_;  // by candidate's group, dense numbering
    std::vector<Index> group_;
};

}  // namespace posewise::detail
