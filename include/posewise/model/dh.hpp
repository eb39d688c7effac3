#pragma once

#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise {

/// One row of a Denavit-Hartenberg table: lengths in m, angles in rad. Of the quantity that the
/// joints drive the nominal value is the joint's offset.
struct DhRow {
    double a = 0;
    double alpha = 0;
    double d = 0;
    double theta = 0;
    Motion motion = Motion::Rotation;  ///< a rotation drives theta, a translation d
    std::vector<JointTerm> joints;     ///< empty: a fixed row (of a pedestal or a tool)
    /// About y, of the standard convention only: where the next axis is nearly parallel it stands
    /// for d, which would be far [Hayati 1983, "Robot arm geometric link parameter estimation"].
    double beta = 0;
};

/// The row as elements, those that do nothing left out. Standard convention: a and alpha are those
/// of the link after the joint; RotZ(theta) TransZ(d) TransX(a) RotX(alpha) [Denavit & Hartenberg
/// 1955] RotY(beta) [Hayati 1983].
std::vector<Element> dh_elements(const DhRow& row);

/// Modified convention: a and alpha are those of the link before the joint;
/// RotX(alpha) TransX(a) RotZ(theta) TransZ(d) [Craig 1986, eq. 3.6]. It has no beta.
std::vector<Element> mdh_elements(const DhRow& row);

/// A whole chain as rows of the standard convention, exact for all joint values: from base to
/// flange a fixed row to the axis of the first joint (left out if that is the base's z axis), one
/// row for each element that joints drive, a fixed row (theta and d only) to the flange (left out
/// if it does nothing). Each row follows the common normal to the next axis; of parallel axes
/// (within 1e-12 rad) the one through its own origin. Where the next axis is nearly parallel
/// (within 0.1 rad) the row leads to where that meets the plane through its own origin across its
/// own axis, by theta, a, alpha and beta. Of the two rows that turn x either way the one nearer to
/// what the chain's elements state, where these are such rows. `parameters` are the chain's error parameters (rad or m);
/// those of error terms, which no row can express, count as zero.
std::vector<DhRow> dh_rows(const Chain& chain, const VectorXd& parameters);

}  // namespace posewise
