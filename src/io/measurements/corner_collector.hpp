#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "posewise/measurement/camera_sensor.hpp"
#include "sample_collector.hpp"

namespace posewise::detail {

/// A corner in an image, as a row of a file has it.
struct Corner {
    std::string id;    ///< of the configuration
    std::string name;  ///< of the sample; empty where the file has none
    VectorXd joints;
    Index number = 0;                     ///< from 0
    Vector2d place = Vector2d::Zero();    ///< thousands of pixels
    std::vector<FileLocation> locations;  ///< of each joint
};

/// Corners row by row, in any order, on the way to samples.
class CornerCollector {
  public:
    explicit CornerCollector(const Campaign& campaign) : campaign_(campaign) {}

    /// Throws InputError if the sample has that corner, or if its joint values differ by over 1e-6
    /// from those of the sample's first corner.
    void add(const Corner& corner);
    /// The samples, in the order of their first corners.
    void add_to(SampleCollector& samples) const;

  private:
    const Campaign& campaign_;
    std::unordered_map<std::string, std::size_t> index_of_;  // of a sample, by both names
    std::vector<Sample> samples_;
    std::vector<std::vector<FileLocation>> locations_;  // of each sample's first row
};

}  // namespace posewise::detail
