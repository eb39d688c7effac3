#pragma once

#include <functional>

#include "posewise/task/planning.hpp"

/// What verification of both kinds of plans shares.
namespace posewise::detail {

/// Relative to the larger; D is a logarithm, so its zero means nothing. Infinite ones are equal.
bool is_same_value(Criterion criterion, double a, double b, double tolerance);

/// Collects findings.
class Findings {
  public:
    void note(const std::string& name, bool is_right, const std::string& text);
    void compare(const std::string& name, double stated, double actual, bool is_right);
    /// The criterion's value; wrong, too, where the poses do not identify the parameters.
    void compare_value(Criterion criterion, double stated, double actual, double tolerance);
    /// Whether a plan is of the parameters that the campaign has now; notes it if not, for then no
    /// other number of it can be compared.
    bool has_same_parameters(const Plan& plan, const Campaign& campaign);
    /// Noise and scales that a plan states against those of the campaign.
    void compare_assumptions(const Plan& plan, const Campaign& campaign);

    std::vector<Finding> take() { return std::move(findings_); }

  private:
    std::vector<Finding> findings_;
};

/// What `check` finds, up to where an InputError ends it.
Verification collect(Index candidate_count, const std::function<void(Findings&)>& check);

}  // namespace posewise::detail
