#pragma once

#include <vector>

#include "io/format/csv_reader.hpp"
#include "measurement_columns.hpp"

/// The header of a CSV file of measurements or configurations.
namespace posewise::detail {

/// A column of a file of measurements or configurations.
struct Column {
    Role role = Role::Sample;
    Index index = 0;             ///< of the joint, of the number in an observation or in its form
    const Unit* unit = nullptr;  ///< of joints and observations
    std::size_t form = 0;        ///< of orientation_forms
    bool is_ros = false;         ///< of a pose, named as by ROS without a unit, which is m there
};

struct Header {
    std::vector<Column> columns;
    std::vector<std::string> unused;  ///< names of columns that nothing is known about
};

/// What of a row is read: observations, or without them (their columns may be missing or hold
/// anything) which targets the column visible_targets lists, of candidates, all different, or of a
/// program, which may hold the same pose more than once.
enum class Content { JointsAndObservations, JointsAndVisibleTargets, Program };

/// The columns of the row that `csv` has just read. `q1_rad` is looked up by its stem and its unit
/// checked. Throws InputError with the place for columns that are missing or there twice; for
/// unknown ones, too, unless observations are read and it is neither nearly the name of a column
/// that is not there nor that of a joint or target which the campaign does not have.
Header read_header(const CsvReader& csv, const Campaign& campaign, Content content);

}  // namespace posewise::detail
