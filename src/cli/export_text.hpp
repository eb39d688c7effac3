#pragma once

#include <string>

#include "posewise/io/campaign_file.hpp"
#include "posewise/io/documents.hpp"

namespace posewise::cli {

/// Where the forms of a robot are written; empty: nowhere.
struct ExportPaths {
    std::string urdf;
    std::string dh;
    std::string ur_kinematics;
    std::string mujoco;
    std::string robodk;
    std::string map;
    std::string camera;
    std::string offsets;
};

/// Warnings about numbers that are easily taken for something else.
void warn_of(const io::ExportedRobot& robot, const ExportPaths& paths);

/// What was written, what it lacks, and how it was read back.
void print_export(const io::ExportedRobot& robot, const io::CampaignFile& file,
                  const ExportPaths& paths);

}  // namespace posewise::cli
