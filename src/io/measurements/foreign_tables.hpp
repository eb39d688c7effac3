#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

/// Tables of measurements that other calibration programs write, which have joint values and poses
/// or points in columns of their own.
namespace posewise::detail {

enum class ForeignTable {
    None,
    /// RoboDK's table of a calibration project: a header; then six joints (deg), what was measured,
    /// and the tool, both as x, y, z (mm) and for poses three angles: 18 columns, of points 12.
    RoboDk,
    /// pybotics' table of joints and poses: joints (deg, or mm), then the 16 numbers of a 4 x 4
    /// matrix by rows, mm. No header; lines after # are comments.
    Pybotics,
};

/// By the first rows. Throws InputError for what would be RoboDK's but for its header or columns.
ForeignTable foreign_table(const std::string& path, const std::string& content,
                           const Campaign& campaign);

/// Reads such a table for a sensor of points or poses; its rows are called 1, 2, ... Joints are as
/// the file has them, which may be the controller's. RoboDK's angles are radians of Rx Ry Rz, as
/// its API reads them, or degrees, or of Rz Ry Rx: those by which the robot turns as its joints
/// say. Of several tools each is a target. What is passed over stands in MeasurementsFile::joined.
/// Throws InputError with path:line:column.
io::MeasurementsFile read_foreign_table(const std::string& path, std::string content,
                                        const io::CampaignFile& file, ForeignTable kind);

}  // namespace posewise::detail
