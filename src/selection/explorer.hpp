#pragma once

#include "part.hpp"

namespace posewise::detail {

/// Searches one part of all choices: the relaxation, from the weights of the part before it, bounds
/// it; the prices of its certificate rule out or take candidates; few choices are all tried, others
/// split. What is too much work for one go is left, in smaller parts.
class Explorer {
  public:
    /// `best`: what is known already.
    Explorer(const PartSetting& setting, const ScoredPoses& best);

    void explore(Part part) { explore(std::move(part), true); }

    std::vector<Part>& left() { return left_; }
    const ScoredPoses& best() const { return enumerator_.best(); }
    Index tried() const { return enumerator_.tried(); }
    double seconds() const;  ///< of a CPU, counted in operations

  private:
    void explore(Part part, bool is_whole);
    bool close(Part& part);
    bool try_few(const Part& part);
    void relax(Part& part);
    bool may_identify(const Part& part);
    double value() const { return best().score.value; }

    const PartSetting& setting_;
    Enumerator enumerator_;
    std::vector<Part> left_;
    double operations_ = 0;  // without those of the enumerator
};

}  // namespace posewise::detail
