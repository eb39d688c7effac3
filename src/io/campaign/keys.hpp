#pragma once

#include <vector>

#include "io/format/yaml_reader.hpp"

/// Every key of a campaign file: what its readers take, what `help KEY` prints, and the tables of
/// the manual, designs/README.md.
namespace posewise::detail::keys {

extern const YamlKeys file, planning, robot, joint, dh, row, terms, weight, sensor, camera, board,
    noise, places, spread, measurements, mat, cell, joint_sum, keep_out, solid, link, sight,
    controller, record;

const std::vector<const YamlKeys*>& all();

}  // namespace posewise::detail::keys
