#pragma once

#include <set>
#include <string>

#include "planning_problem.hpp"

namespace posewise::detail {

/// p1, p2, ... but for those that poses kept, dropped or measured already have.
class NewIds {
  public:
    NewIds(char letter, const PlanningProblem& problem)
        : letter_(letter), taken_(problem.request.dropped.begin(), problem.request.dropped.end()) {
        taken_.insert(problem.measured_ids.begin(), problem.measured_ids.end());
        for (const PlannedPose& pose : problem.kept) taken_.insert(pose.id);
        for (const PlannedPose& pose : problem.kept_to_verify) taken_.insert(pose.id);
    }
    std::string next() {
        std::string id;
        do id = letter_ + std::to_string(++last_);
        while (taken_.count(id) > 0);
        return id;
    }

  private:
    char letter_;
    std::set<std::string> taken_;
    int last_ = 0;
};

}  // namespace posewise::detail
