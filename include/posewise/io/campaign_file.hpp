#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/io/urdf_file.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise::io {

/// Which variables of a MATLAB file hold what.
struct MatMapping {
    std::string joints = "q";         ///< samples x joints
    std::vector<std::string> points;  ///< one variable a target, samples x 3
    std::string torques = "tau";      ///< samples x measured torques, N m
    double angle_unit = 1;            ///< of revolute joints, in rad
    double length_unit = 1;           ///< of points and prismatic joints, in m
};

/// Which error parameters the robot of a campaign has.
enum class ErrorModel {
    Stated,    ///< those that the file names in brackets
    Offsets,   ///< the joints' zeros, reduced to those that can be told apart
    Complete,  ///< every geometric error of a rigid link, reduced to an irreducible set
    Full,      ///< full_model(), with the sizes of errors that robots have as priors: the default
};

/// "stated", "offsets", "geometric" or "full", as files state it under `errors`.
std::string_view error_model_name(ErrorModel model);
/// The model of that name ("complete" is geometric, too). Throws InputError for any other.
ErrorModel parse_error_model(const std::string& name);

/// A campaign, what else its file says, and the defaults of the command line.
struct CampaignFile : Campaign {
    std::string path;
    std::string checksum;  ///< of the file's text
    /// The robot as the file's elements state it. With ErrorModel::Complete, `robot` is the
    /// irreducible form of its complete model, with ErrorModel::Offsets that of its joints' zeros,
    /// with ErrorModel::Full its full model, else the same.
    Chain declared_robot;
    /// Angles of the robot that the file rounds, within 1e-6 rad of a multiple of 90 deg: they are
    /// taken as that.
    Index rounded_angle_count = 0;
    ErrorModel error_model = ErrorModel::Stated;
    /// What select and plan reckon with instead, as the file says under `planning`.
    std::optional<ErrorModel> planned_model;
    std::optional<UrdfSource> urdf;     ///< where the robot comes from, if from a URDF
    std::vector<std::string> warnings;  ///< what was not understood of it, a sentence each
    Criterion criterion = Criterion::V;
    std::uint64_t seed = 1;
    MatMapping mat;
};

/// Says whether the expected sizes are priors, whatever the file says. Without them a full model is
/// reduced to what poses can tell apart. Throws InputError if it is stopped at that.
void set_prior(CampaignFile& campaign, bool is_prior, const StopSignal& stop = {});

/// Reads a campaign from YAML. Throws InputError with path:line:column for anything missing,
/// misspelt or out of range.
///
/// An element of the robot is written `kind amount [parameter]`: the kind is T or R and an axis,
/// the amount a sum of lengths or angles with their unit and of joints, each with an optional
/// coefficient, the bracket names its error parameter and may be missing:
/// `Rz q1`, `Tx 312 mm [Tx1]`, `Ry q2 + 0.5 deg [dq2]`, `Ry -q3 + 0.98*q2`, `Ty 0 [Ty1]`. Further
/// brackets hold errors that depend on the configuration, a parameter times a function of joints:
/// `Ry q2 [dq2] [k1*sin(q2)] [k2*cos(q2 - q3 + 28 deg)]`, `Ry -q3 [coupling*(q2 - 0.5*q4)]`.
///
/// `gravity: true` adds the terms of with_gravity_terms(); `gravity: {direction: [0, 0, -1],
/// joints: [q2]}` says which way gravity acts in the base frame and on which joints. `harmonics:
/// {orders: [1, 2], joints: [q4]}` adds those of with_harmonics(). `compliance: {links: {q2:
/// {mass_kg: 20, center_mm: [0, 0, 150]}}, payload: {mass_kg: 5, center_mm: [0, 0, 80]}}` adds
/// those of with_compliance(), with centres of mass in the frame after the joint and of the
/// flange; `direction` and `joints` as for gravity; `links: urdf` takes masses and centres from the
/// URDF. `compliance: {torques_Nm: {q2: 300, q3: 120}}` adds those of with_measured_compliance(),
/// with the largest torques that occur. Their sizes in `spread` are `gravity_mrad` (compliance too)
/// and `harmonic_mrad`.
///
/// Instead of elements and joints the robot may have a Denavit-Hartenberg table, `dh`, with its
/// `convention` (standard or modified) and `rows` from base to flange:
/// `{joint: q1, a_mm: 0, alpha_deg: 90, d_mm: 127.3, theta_deg: 0, limits_deg: [-360, 360]}`.
/// All four amounts must be stated, of the driven one the joint's offset. A row may have
/// `kind: prismatic` (the joint drives d), `drive: -q3 + q2` (reversed, coupled), and no joint.
///
/// Or it may come from a URDF: `urdf` (a path from the campaign file's folder), `base_link` and
/// `tip_link`; `joints` may then replace limits and add repeatabilities. The speeds of the URDF are
/// those of the cell unless that states its own.
///
/// The sensor is of `kind: points` (with `targets`), `poses` (`tool`, `sigma_orientation_mrad`),
/// `distances` (`anchors`, `targets`), `planes` (`planes`, `known_planes`, `targets`) or `sockets`
/// (`sockets`, `known_sockets`, `targets`). `known` is a boolean or lists what is: of targets axes,
/// of the base x .. rz, of a plane `normal` and `offset`.
///
/// The sensor's noise is `sigma_mm` (one number, or three for x, y and z) or that of a laser
/// tracker, `noise: {range_um: 10, angle_urad: 15}`. The section `cell` states the constraints of
/// poses; designs/cell_demo/campaign.yaml has each of its keys.
///
/// What stops it ends the search for an irreducible model, with an error.
CampaignFile read_campaign(const std::string& path, const StopSignal& stop = {});

/// The same from a text that is not in its file (yet). Paths in it are from the folder of `path`.
CampaignFile parse_campaign(const std::string& content, const std::string& path,
                            const StopSignal& stop = {});

/// The campaign of a file as poses are planned for it: with the error model that it states under
/// `planning`, if it does, and then with the Campaign::fitted_pose_count of the one that it states
/// under `robot`. The expected sizes are priors as asked, else as the file says.
CampaignFile read_planned_campaign(const std::string& path, std::optional<bool> prior = {},
                                   const StopSignal& stop = {});

/// The campaign of a file with each of these error models in turn, whatever it states under
/// `errors`; expected sizes of single parameters that a model does not have are left out.
std::vector<CampaignFile> read_campaign(const std::string& path,
                                        const std::vector<ErrorModel>& models);

}  // namespace posewise::io
