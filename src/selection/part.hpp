#pragma once

#include "enumeration.hpp"
#include "working_set.hpp"

namespace posewise::detail {

/// What all parts of one proof share. Candidates are places in the working set.
struct PartSetting {
    const SearchProblem& problem;
    const Objective& objective;  ///< softened as in the certificate
    const WorkingSet& set;
    const EnumerationSetting& enumeration;

    Index candidate(Index place) const { return set.members()[static_cast<std::size_t>(place)]; }
    std::vector<Index> candidates(const std::vector<Index>& places) const;
};

/// Those choices that take some candidates and none of those ruled out.
struct Part {
    std::vector<Index> taken;  ///< one listed twice is taken twice
    std::vector<Index> open;   ///< may be taken, too
    VectorXd weights;          ///< relaxed, of those open
    Pricing pricing;           ///< of those open

    Index missing(const PartSetting& setting) const;
    /// How often each open candidate may be taken.
    std::vector<Index> capacity(const PartSetting& setting) const;
    PricedChoices choices(const PartSetting& setting) const;
};

/// The `missing` of largest values, each taken as often as it may be.
std::vector<Taken> most_valuable(const VectorXd& values, const std::vector<Index>& capacity,
                                 Index missing);

/// What a choice's prices sum to at most, above what they must for it to be as good as what is
/// known; negative: no choice is.
double spare_price(const Pricing& pricing, const std::vector<Taken>& dearest);

enum class Left {
    None,  ///< no choice of the part is allowed and as good as what is known
    One,   ///< the candidates taken
    Many,
};
/// Rules out what limits do not allow and what prices do not, and takes what they demand, until
/// nothing changes.
Left reduce(const PartSetting& setting, double value, Part& part);

/// With and without the open candidate of the largest weight.
std::array<Part, 2> split(const PartSetting& setting, const Part& part);

}  // namespace posewise::detail
