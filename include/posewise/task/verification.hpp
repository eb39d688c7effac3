#pragma once

#include "posewise/task/choice.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {

/// Whether one thing about a plan is as it states.
struct Finding {
    std::string name;  ///< "poses", "bound"
    bool is_right = true;
    std::string text;  ///< empty: the two numbers say it
    double stated = 0;
    double actual = 0;
};

/// What was found about a plan, in the order it was checked.
struct Verification {
    Index candidate_count = 0;  ///< to choose from; of continuous plans: poses
    std::vector<Finding> findings;
    /// Why checking ended there: "poses[2].id: 'p9' is not among the candidates". Empty: it did
    /// not.
    std::string obstacle;

    /// Names of what is not as stated, none twice.
    std::vector<std::string> wrong() const;
    bool is_right() const { return obstacle.empty() && wrong().empty(); }
};

/// Computes value, bound and efficiency of a choice again from the inputs it was made from and its
/// certificate; checks the candidates by their checksum, the poses and the limits. `options` are
/// the plan's request with its inputs. Where a plan claims to be optimal beyond its certificate
/// that search is made again. Throws InputError as choose().
Verification verify(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options);
/// The same of plain blocks.
Verification verify(const Plan& plan, const Blocks& candidates, const ChoiceOptions& options);

/// Checks every pose of a continuous plan (joint limits, the cell's constraints, targets seen), its
/// value and its predicted accuracy; its bounds cannot be proven from what a plan holds. Throws
/// InputError as make_plan(), and for a plan of another campaign.
Verification verify(const Plan& plan, const Campaign& campaign, const PlanningOptions& options);

}  // namespace posewise
