#pragma once

/// All that a program needs: one call a task, what it takes and what it gives. Single headers of a
/// module serve those who want less.
#include "posewise/core/reproducible.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/correction_file.hpp"
#include "posewise/io/dh_file.hpp"
#include "posewise/io/estimate_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/plan_file.hpp"
#include "posewise/io/urdf_file.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/measurement/simulation.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/doubts.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/study.hpp"
#include "posewise/task/verification.hpp"
