#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The vector and matrix names every module shares. SI doubles throughout: metres and radians.
namespace posewise {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Rows are observations, so one pose's rows are contiguous in memory.
using RowMatrixXd = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Columns are twists (angular; linear), see Chain::differentiate().
using TwistMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic>;

}  // namespace posewise
