#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posewise/task/calibration.hpp"

namespace posewise::io {

/// What an estimate was made from: paths, and checksums where they are known.
struct Provenance {
    std::string measurements{};
    std::string measurements_checksum{};  ///< checksum_of()
    std::string campaign_file{};
    std::string campaign_checksum{};  ///< CampaignFile::checksum
    /// Of the command line: its name and what was said.
    std::vector<std::pair<std::string, std::vector<std::string>>> options{};
    std::vector<std::string> warnings{};  ///< what was warned of, a sentence each
};

/// Tells whether measurements are the same: of configurations, their ids, what was observed there.
std::string checksum_of(const Measurements& measurements);

/// Writes a calibration as JSON, units in the names (accuracy in mm, all else in m and rad),
/// numbers with as many digits as it takes to read them back exactly. Same input, same bytes. The
/// calibration must be identified.
void write_estimate(const std::string& path, const Calibration& calibration,
                    const Provenance& made_from);

/// Writes CSV, a row a configuration: config, then parameters, left_over, noise, total (RMS) and
/// p95 (95 % of points are off by less), each with _mm, of orientations with _mrad. `ids` are those
/// of the configurations predicted.
void write_predictions_csv(const std::string& path, const std::vector<std::string>& ids,
                           const std::vector<ErrorPrediction>& predictions);

/// What such a file holds, exactly as it was: parameters, names, covariance, ending, variance
/// factor, degrees of freedom, model errors. Throws InputError with the place if it is none, if it
/// is of another robot than the campaign's (see designs/README.md) or of another kind of sensor.
/// Whether it can be used is for find_faults() to say, and for EarlierFile::faults.
Estimate read_estimate(const std::string& path, const Campaign& campaign);

/// The same as an earlier estimate, with the sizes of errors that were learned along. Targets (the
/// sensor's unknowns) that were moved since may be others now, seen by another kind of sensor: they
/// are as the campaign states them, with covariance 0.
struct EarlierFile : Earlier {
    /// Where the campaign's noise or expected sizes are others now: "sigma_m was 1e-05, is 2e-05".
    std::vector<std::string> changes;
    std::vector<std::string> warnings;  ///< that were given when it was made, a sentence each
    /// Calibration::faults, where it was written all the same: it must not be used.
    std::vector<std::string> faults;
};
EarlierFile read_earlier(const std::string& path, const Campaign& campaign, const EarlierUse& use);

/// Whether measurements are those of a checksum, all of them or less what is excluded of them.
bool are_of_checksum(const std::string& checksum, const Measurements& measurements,
                     const std::vector<std::string>& excluded);

/// Whether an estimate says that it was made from these measurements, or from them less what it
/// says was excluded.
bool is_made_from(const std::string& estimate_path, const Measurements& measurements);

}  // namespace posewise::io
