#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/criteria/criterion.hpp"

namespace posewise {

/// How well one subset calibrates the robot.
struct StudyCase {
    std::vector<Index> poses;
    bool identified = false;  ///< false: these poses cannot identify the model
    /// Means of the configurations left out (so that repeat noise does not blur the comparison); no
    /// points if none is left.
    Metrics held_out;
};

/// All subsets of one size.
struct StudyRow {
    Index pose_count = 0;
    std::vector<StudyCase> optimal;  ///< one for each asked criterion
    std::vector<StudyCase> random;
};

struct StudyOptions {
    std::vector<Criterion> criteria{Criterion::D};
    std::vector<Index> pose_counts;  ///< empty: from the least identifying count to all but one
    Index random_subsets = 100;
    Index starts = 20;  ///< of the exchange
    std::uint64_t seed = 1;
    ProgressCallback progress{};  ///< of the cases
};

/// Accuracy against number of poses: choose k of the measured configurations by each criterion and
/// at random, calibrate with them from registration on, and judge on the configurations left out.
/// The same result for any number of threads.
/// Throws InputError if not even all configurations identify the model, or for a pose count that is
/// not in [1, configurations].
std::vector<StudyRow> study_pose_counts(const Campaign& campaign, const Measurements& measurements,
                                        const StudyOptions& options);

/// The p-quantile (0..1, linear between order statistics) of the held-out distance RMS. Cases that
/// are not identified count as worse than any other, so that dropping them cannot flatter the rest;
/// nothing if the quantile falls among them or nothing was left out.
std::optional<double> held_out_quantile(const std::vector<StudyCase>& cases, double p);

}  // namespace posewise
