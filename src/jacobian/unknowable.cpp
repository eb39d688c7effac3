#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/decompositions.hpp"
#include "core/text.hpp"
#include "nominal_factor.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise {
namespace {

/// Columns of parameters that one word of a key `known` makes known.
struct Word {
    std::string word;
    std::vector<Index> columns;
};

/// The words that may stand at a key: of unknowns "target1.x" and "target2.x" x is one.
std::vector<Word> find_words(const std::vector<std::string>& names, const std::string& begin,
                             const std::vector<std::string>& ends) {
    std::vector<Word> words;
    for (const std::string& end : ends) {
        Word found{end, {}};
        for (std::size_t k = 0; k < names.size(); ++k) {
            if (names[k].starts_with(begin) && names[k].ends_with('.' + end)) {
                found.columns.push_back(static_cast<Index>(k));
            }
        }
        if (!found.columns.empty()) words.push_back(std::move(found));
    }
    return words;
}

class Search {
  public:
    Search(const Campaign& campaign, const StopSignal& stop)
        : J_(detail::factor_at_nominal(campaign, stop)),
          least_shares_(detail::least_shares_of(campaign)),
          stop_(stop) {}

    std::vector<Index> dropped_without(const std::vector<Index>& known) const {
        const std::vector<Index> open = open_beside(known);
        std::vector<Index> all(open.size());
        std::iota(all.begin(), all.end(), Index{0});
        std::vector<Index> dropped;
        if (open.empty()) return dropped;
        const auto found = find_independent_columns(J_(Eigen::all, open), all, least_residual,
                                                    stop_, least_shares_(open));
        for (const DroppedParameter& one : found.dropped) {
            dropped.push_back(open[static_cast<std::size_t>(one.parameter)]);
        }
        return dropped;
    }

    /// The fewest of these words that leave nothing unknowable, beside what else is known; of as
    /// many those with which all is told best.
    std::optional<std::vector<std::string>> fewest_words(const std::vector<Word>& there,
                                                         const std::vector<Index>& beside) const {
        const auto count = static_cast<unsigned>(there.size());
        for (int size = 1; size <= static_cast<int>(count); ++size) {
            std::optional<std::vector<std::string>> best;
            double best_told = 0;
            for (unsigned choice = 1; choice < (1U << count); ++choice) {
                if (std::popcount(choice) != size) continue;
                std::vector<Index> known = beside;
                std::vector<std::string> words;
                for (unsigned k = 0; k < count; ++k) {
                    if ((choice >> k & 1U) == 0) continue;
                    words.push_back(there[k].word);
                    known.insert(known.end(), there[k].columns.begin(), there[k].columns.end());
                }
                if (!dropped_without(known).empty()) continue;
                const double told = least_told(known);
                if (best && told <= (1 + 1e-6) * best_told) continue;  // the first of equals
                best = std::move(words);
                best_told = told;
            }
            if (best) return best;
        }
        return std::nullopt;
    }

  private:
    std::vector<Index> open_beside(const std::vector<Index>& known) const {
        std::vector<Index> open;
        for (Index k = 0; k < J_.cols(); ++k) {
            if (std::ranges::find(known, k) == known.end()) open.push_back(k);
        }
        return open;
    }

    /// The least singular value of the open columns, of norm 1.
    double least_told(const std::vector<Index>& known) const {
        MatrixXd J = J_(Eigen::all, open_beside(known));
        if (J.cols() == 0) return std::numeric_limits<double>::infinity();
        J.colwise().normalize();
        return std::sqrt(
            std::max(0.0, detail::eigen_decomposition(J.transpose() * J, Eigen::EigenvaluesOnly)
                              .eigenvalues()[0]));
    }

    MatrixXd J_;
    VectorXd least_shares_;
    const StopSignal& stop_;
};

std::vector<KnownAxes> find_cures(const Search& search, const std::vector<std::string>& names) {
    const auto base = find_words(names, "base", {"x", "y", "z", "rx", "ry", "rz"});
    const auto targets = find_words(names, "target", {"x", "y", "z"});
    std::vector<KnownAxes> cures;
    if (const auto words = search.fewest_words(base, {})) cures.push_back({*words, {}});
    if (const auto words = search.fewest_words(targets, {})) cures.push_back({{}, *words});
    if (!cures.empty() || targets.empty()) return cures;
    std::vector<Index> all;
    std::vector<std::string> axes;
    for (const Word& word : targets) {
        all.insert(all.end(), word.columns.begin(), word.columns.end());
        axes.push_back(word.word);
    }
    if (const auto words = search.fewest_words(base, all)) cures.push_back({*words, axes});
    return cures;
}

std::string state(const std::vector<std::string>& words, const char* keys) {
    return fmt::format("known: [{}], {}", fmt::join(words, ", "), keys);
}

}  // namespace

Unknowable find_unknowable(const Campaign& campaign, const StopSignal& stop) {
    Unknowable found;
    Campaign bare = with_robot(campaign, without_parameters(campaign.robot));
    // Most bases stand upright, if not as a camera sees them.
    if (!campaign.has_nominal_base && !campaign.sensor->has_view()) {
        bare.nominal.world_from_base.linear().setIdentity();
    }
    const auto& prior = campaign.prior;
    if ((prior && (prior->has_base || prior->has_sensor)) || parameter_count(bare) == 0) {
        return found;
    }
    bare.prior.reset();
    const Search search(bare, stop);
    const std::vector<std::string> names = parameter_names(bare);
    for (const Index k : search.dropped_without({})) {
        found.parameters.push_back(names[static_cast<std::size_t>(k)]);
    }
    if (!found.parameters.empty()) found.cures = find_cures(search, names);
    return found;
}

std::string describe_cures(const Unknowable& unknowable, const Campaign& campaign) {
    const std::vector<KnownAxes>& cures = unknowable.cures;
    if (cures.size() == 2 && cures[0].base == cures[1].targets) {
        return state(cures[0].base, "keys base.known or sensor.targets.known");
    }
    std::vector<std::string> words;
    for (const KnownAxes& cure : cures) {
        std::string text;
        if (!cure.base.empty()) text = state(cure.base, "key base.known");
        if (!cure.targets.empty()) {
            text +=
                (text.empty() ? "" : ", and ") + state(cure.targets, "key sensor.targets.known");
        }
        words.push_back(std::move(text));
    }
    if (words.empty()) words = campaign.sensor->words().known;
    return fmt::format("{}", fmt::join(words, ", or "));
}

void check_knowable(const Campaign& campaign, const StopSignal& stop) {
    const Unknowable found = find_unknowable(campaign, stop);
    if (found.parameters.empty()) return;
    throw InputError(fmt::format(
        "{}: no number of poses tells {}; the campaign must state what is known, with position_mm: "
        "{}",
        campaign.name, detail::list_words(found.parameters), describe_cures(found, campaign)));
}

}  // namespace posewise
