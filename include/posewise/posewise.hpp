#pragma once

/// Everything a program needs: one call per task, with its inputs and results. To use less, include
/// single headers.
#include "posewise/core/progress.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/doubts.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/scene.hpp"
#include "posewise/task/study.hpp"
