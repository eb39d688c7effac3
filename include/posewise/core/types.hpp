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

/// How a rigid body moves: angular velocity w; velocity v of the point at the world origin. A point
/// x of the body moves by v + w cross x.
using Twist = Eigen::Matrix<double, 6, 1>;

/// Columns are twists, see Chain::differentiate(). By rows, so that loops over columns are
/// vectors'.
using TwistMatrix = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace posewise
