#pragma once

#include <cstdint>
#include <optional>
#include <string>
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
    StopSignal stop{};            ///< ends it with the pose counts that are complete
    ProgressCallback progress{};  ///< of the cases
};

/// Accuracy against number of poses.
struct Study {
    std::string campaign;             ///< its name
    std::vector<std::string> ids;     ///< of the configurations
    std::vector<Criterion> criteria;  ///< by which were chosen, as StudyRow::optimal has them
    std::vector<StudyRow> rows;       ///< none if there is nothing to study
    Ending ending = Ending::NotRun;
    /// Where it is NotIdentifiable, why not even all configurations identify the model.
    std::string undetermined;
};

/// Chooses k of the measured configurations by each criterion and at random, calibrates with them
/// from registration on, and judges on the configurations left out. The same result for any number
/// of threads.
/// Throws InputError for measurements of another robot (check_is_of_robot()), for a pose count that
/// is not in [1, configurations], and for other options out of range.
Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options = {});

/// The p-quantile (0..1, linear between order statistics) of the held-out distance RMS. Cases that
/// are not identified count as worse than any other, so that dropping them cannot flatter the rest;
/// nothing if the quantile falls among them or nothing was left out.
std::optional<double> held_out_quantile(const std::vector<StudyCase>& cases, double p);

}  // namespace posewise
