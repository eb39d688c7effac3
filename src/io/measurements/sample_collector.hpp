#pragma once

#include <functional>
#include <string>
#include <unordered_map>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::detail {

/// One sample, as a row of a file has it.
struct Sample {
    std::string id;        ///< of the configuration
    std::string name;      ///< of the sample; empty where the file has none
    VectorXd joints;       ///< the configuration: rad or m, then measured torques
    VectorXd observation;  ///< m; without what was observed if only configurations are read
    SeenTargets is_seen;   ///< at least one of them
};

/// Samples as a file has them, row by row in any order, on the way to Measurements.
class SampleCollector {
  public:
    /// Where joint j of the row at hand stands in the file.
    using LocateJoint = std::function<FileLocation(Index joint)>;

    explicit SampleCollector(const Campaign& campaign) : campaign_(campaign) {}

    /// One more sample. Throws InputError if its joint values differ by over 1e-6 from those of the
    /// configuration's first sample, or what it touches is another, or a torque is over twice the
    /// largest that occurs. Torques may differ: the configuration's are their means. One that is
    /// apart is a configuration by itself, whatever its id.
    void add(const Sample& sample, const LocateJoint& locate, bool is_apart = false);

    /// Samples grouped by configuration, in the order the configurations first occurred; the robot
    /// may come back to a pose under another id. Throws InputError if there are none or if half of
    /// the configurations are others once more, with the same readings.
    Measurements finish(const std::string& path) const;

  private:
    void check_same_joints(Index configuration, const VectorXd& joints,
                           const LocateJoint& locate) const;
    void check_same_contact(Index configuration, const SeenTargets& is_seen,
                            const FileLocation& location) const;
    void check_torques(const VectorXd& configuration, const LocateJoint& locate) const;
    void check_not_copied(const Measurements& measurements) const;

    const Campaign& campaign_;
    std::unordered_map<std::string, Index> configuration_of_id_;
    std::vector<std::string> ids_;
    std::vector<VectorXd> configurations_;    // of the first sample, torques added up
    std::vector<SeenTargets> first_seen_;     // of each configuration
    std::vector<FileLocation> first_places_;  // of each configuration
    std::vector<Index> configuration_;        // of each sample
    std::vector<std::string> names_;          // of each sample
    std::vector<double> observations_;        // of all samples, one after another
    std::vector<SeenTargets> is_seen_;        // of each sample
};

/// Throws InputError (at `locate()`) if a revolute joint's value, read in rad, lies over four turns
/// beyond its limits: as degrees do.
void check_not_degrees(const Chain& robot, Index joint, double value,
                       const std::function<FileLocation()>& locate);

}  // namespace posewise::detail
