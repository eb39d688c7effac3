#pragma once

#include <string>
#include <vector>

#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/campaign.hpp"

/// What verification finds.
namespace posewise::cli {

/// Findings, printed as they come; the names of what is wrong are kept.
class Findings {
  public:
    void note(const std::string& name, bool is_right, const std::string& text);
    void compare(const std::string& name, double stated, double actual, bool is_right);
    /// Throws InputError, naming what is wrong, if anything is.
    void conclude(const std::string& path) const;

  private:
    std::vector<std::string> wrong_;
};

/// Relative to the larger; D is a logarithm, so its zero means nothing. Infinite ones are equal.
bool is_same_value(Criterion criterion, double a, double b, double tolerance);

/// Noise and scales that a plan states against those of the campaign.
void check_assumptions(const std::string& path, const Campaign& campaign, Findings& findings);

}  // namespace posewise::cli
