#include "recombination.hpp"

#include <algorithm>
#include <iterator>

#include "core/parallel.hpp"

namespace posewise::detail {
namespace {

constexpr std::size_t most_members = 12;
constexpr Index idle_generations = 3;  // generations that change nothing, to end after

using Poses = std::vector<Index>;

void shuffle(Poses& poses, RandomStream& random) {
    for (std::size_t i = poses.size(); i > 1; --i) {
        std::swap(poses[i - 1],
                  poses[static_cast<std::size_t>(random.index(static_cast<Index>(i)))]);
    }
}

/// K poses: what both have, then those of either in random order, then any of the shortlist, as the
/// limits allow. Fewer where they leave no more.
Poses cross(const SearchProblem& problem, const Shortlist& shortlist, const Poses& a,
            const Poses& b, RandomStream& random) {
    Poses order;
    Poses either;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(order));
    std::set_symmetric_difference(a.begin(), a.end(), b.begin(), b.end(),
                                  std::back_inserter(either));
    shuffle(either, random);
    order.insert(order.end(), either.begin(), either.end());
    order.insert(order.end(), shortlist.members.begin(), shortlist.members.end());
    return take_in_order(problem, order);
}

/// Choices that all differ, the best first.
class Population {
  public:
    explicit Population(std::size_t most) : most_(most) {}

    const std::vector<ScoredPoses>& members() const { return members_; }

    /// Of all members, each once.
    Poses poses() const {
        Poses all;
        for (const ScoredPoses& member : members_) {
            all.insert(all.end(), member.poses.begin(), member.poses.end());
        }
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }

    bool has(Poses poses) const {
        std::sort(poses.begin(), poses.end());
        return std::any_of(members_.begin(), members_.end(),
                           [&](const ScoredPoses& member) { return member.poses == poses; });
    }

    /// Whether it was new and good enough to be taken.
    bool add(ScoredPoses choice) {
        std::sort(choice.poses.begin(), choice.poses.end());
        if (has(choice.poses) || !choice.score.identifies) return false;
        const auto place = std::find_if(
            members_.begin(), members_.end(),
            [&](const ScoredPoses& member) { return choice.score.value > member.score.value; });
        if (place == members_.end() && members_.size() == most_) return false;
        members_.insert(place, std::move(choice));
        if (members_.size() > most_) members_.pop_back();
        return true;
    }

  private:
    std::size_t most_;
    std::vector<ScoredPoses> members_;
};

}  // namespace

ScoredPoses recombine(const SearchProblem& problem, const Shortlist& shortlist,
                      const ScoredPoses& best, const std::vector<ScoredPoses>& choices) {
    Population population(std::min(most_members, choices.size()));
    for (const ScoredPoses& choice : choices) population.add(choice);
    const SelectOptions& options = problem.options;
    const auto children = static_cast<Index>(population.members().size());
    const bool is_far = has_far(problem, shortlist);
    Poses near_to;  // the best
    Shortlist near;
    Index unchanged = 0;
    for (Index generation = 0; unchanged < idle_generations && !options.stop.is_set();
         ++generation) {
        const std::vector<ScoredPoses>& parents = population.members();
        const auto count = static_cast<Index>(parents.size());
        if (count < 2) break;
        std::vector<ScoredPoses> born(static_cast<std::size_t>(children));
        const Shortlist known = make_shortlist(problem.candidates, population.poses());
        if (is_far && near_to != parents.front().poses) {
            near_to = parents.front().poses;
            near = nearest(problem, shortlist, parents.front());
        }
        for_each_index(children, [&](Index child) {
            constexpr Index stream = Index{1} << 32;  // far from those of the starts
            RandomStream random(options.seed,
                                static_cast<std::uint64_t>(stream + generation * children + child));
            const std::vector<Index> pair = random.subset(count, 2);
            Poses poses =
                cross(problem, shortlist, parents[static_cast<std::size_t>(pair[0])].poses,
                      parents[static_cast<std::size_t>(pair[1])].poses, random);
            if (static_cast<Index>(poses.size()) < options.pose_count) return;
            const SearchScore score = problem.score(problem.regularised_information(poses));
            ScoredPoses improved = improve(problem, known, {std::move(poses), score});
            if (population.has(improved.poses)) return;  // nothing improves a member
            if (is_far) {
                improved = improve(problem, near, improved);
                if (!(improved.score.value > parents.back().score.value)) return;
            }
            born[static_cast<std::size_t>(child)] =
                judge(problem, improve(problem, shortlist, improved));
        });
        bool is_changed = false;
        for (ScoredPoses& child : born) {
            if (!child.poses.empty() && population.add(std::move(child))) is_changed = true;
        }
        unchanged = is_changed ? 0 : unchanged + 1;
    }
    const std::vector<ScoredPoses>& found = population.members();
    return !found.empty() && is_better(found.front().score, best.score) ? found.front() : best;
}

}  // namespace posewise::detail
