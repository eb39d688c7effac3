#include "keys.hpp"

namespace posewise::detail::keys {

const YamlKeys file{
    "file",
    {
        {"name", "", "one line of text", "required", "`arm in cell 4`"},
        {"robot", "", "see below", "required", ""},
        {"sensor", "", "see below", "required, or `sensors`", ""},
        {"sensors", "",
         "instead of it several that measure the same robot together, a list with the keys of "
         "`sensor` each; not sockets, nor a camera beside poses",
         "one alone", "`[{kind: points, ...}, {kind: camera, ...}]`"},
        {"base", "", "where the instrument sees the robot's base",
         "made up; simulations need it, plans and random candidates where what poses tell depends "
         "on it (a tracker's noise, lines of sight, distances, planes)",
         "`{position_mm: [4500, 0, -600], rpy_deg: [0, 0, 180]}`"},
        {"model_error_mm", "",
         "what the model cannot express, as noise that repeats do not reduce; 0: nothing. With "
         "`prior` only what is expected: a calibration finds it from the measurements, give or "
         "take a factor of 2.5",
         "`auto`: that of the robot's class, 0.1 mm where it is unknown", "`0.15`"},
        {"model_error_orientation_mrad", "", "the same of measured orientations",
         "`auto`: as many mrad as mm", "`0.25`"},
        {"model_error_common", "",
         "how much of the model error's variance the targets of a configuration share. That part "
         "moves the flange: half of it is a translation, half a rotation about the targets' "
         "middle. Each target has the rest by itself. On real robots with several targets 0.84 to "
         "0.93 was found. Robust losses weigh targets one by one and take 0",
         "0.9 beside priors, else 0", "`0`"},
        {"spread", "", "expected size of each error", "see below", "`{length_mm: 0.5}`"},
        {"prior", "",
         "whether these sizes are prior standard deviations, too: fewer poses than parameters will "
         "do",
         "`true` with `errors: full`, else `false`", "`true`"},
        {"sizes", "",
         "`learned`: a calibration learns the sizes of the robot's errors, starting from those of "
         "the prior. One standard deviation is a factor of 2, so that few poses move them a "
         "little. `stated`: it takes them as they are",
         "`learned`; of `kind: camera` `stated`", "`stated`"},
        {"planning", "",
         "with `{errors: full}`: `select` and `plan` reckon with these errors (what they predict "
         "is that of a calibration with these), all other commands with those of `robot`, which "
         "may be fewer and say how many poses are needed",
         "as `robot` says", "`{errors: full}`"},
        {"criterion", "", "default of `select` and `study`", "`v`", "`d`"},
        {"seed", "", "default of every command", "1", "`7`"},
        {"measurements", "", "what the variables of a MATLAB file are called", "CSV needs none",
         "see below"},
        {"cell", "", "limits of the place", "none", "see below"},
        {"controller", "", "how joints are called and counted where programs run",
         "the robot's own joints", "`{maker: fanuc, j23_factor: 1}`"},
        {"record", "", "who measured with what, for the estimate's document; nothing rests on it",
         "none", "`{operator: A. Smith, serial: LT-204}`"},
    }};

const YamlKeys planning{
    "planning",
    {
        {"errors", "", "as `errors` of the robot: `full`", "required", "`full`"},
    }};

const YamlKeys robot{
    "robot",
    {
        {"elements", "", "elementary transforms from base to flange", "", "see below"},
        {"joints", "",
         "with `elements`: every joint by name; with `urdf`: those that differ from it",
         "required with `elements`", "`{q1: {limits_deg: [-90, 90]}}`"},
        {"dh", "", "a Denavit-Hartenberg table", "", "see below"},
        {"urdf", "", "a URDF, its path from this file's folder", "", "`ur10.urdf`"},
        {"base_link", "", "of the URDF: where the robot begins", "its root", "`base_link`"},
        {"tip_link", "", "of the URDF: what carries the targets", "its only leaf", "`tool0`"},
        {"class", "",
         "what kind of robot it is: `small` (stiff arms for assembly), `industrial`, "
         "`collaborative`, `service` (coarse arms: mobile manipulators, humanoids, low-cost arms) "
         "or `unknown`. Model error and sizes of `errors: full` are expected as such robots have "
         "them, and intervals before measuring are narrower",
         "`unknown`", "`collaborative`"},
        {"errors", "",
         "`none`: base and targets alone (registration, hand-eye); `stated`: those named in "
         "brackets; `offsets`: the joints' zeros alone, those that base and targets do not tell "
         "already; `geometric` (or `complete`): every error a rigid link can have, less what "
         "cannot be identified; `full`: see below; or a list of some of these, by name or class "
         "(offsets, lengths, angles, gravity, harmonics, tilts, gains, terms)",
         "`stated` where a bracket names a constant error, else `full`",
         "`geometric`, `[class:offsets, Tx3]`"},
        {"gravity", "", "errors of joints that bend under the arm's weight: `true`, or a map",
         "none", "`{direction: [0, 0, -1], joints: [q2, q3]}`"},
        {"harmonics", "",
         "errors of encoders, gears and drives of slides (with `pitch_mm`), periodic in the joint",
         "none", "`{orders: [1, 2], joints: [q4]}`"},
        {"axis_tilt", "",
         "tilt error motion of the joints' axes, periodic in the joint (bearings; links that bend)",
         "none", "`{orders: [1, 2]}`"},
        {"gains", "",
         "ratios of gears, in proportion to the joint: `true`, or a map; slides and axes that "
         "follow a joint have theirs with `errors: full` anyway",
         "none", "`{joints: [q4]}`"},
        {"compliance", "", "one compliance a joint, under known or measured torques", "none",
         "see below"},
    }};

const YamlKeys joint{
    "joint",
    {
        {"limits_deg", "", "lower and upper limit of a joint that turns, within three turns",
         "required (URDF: its own)", "`[-90, 90]`"},
        {"limits_mm", "", "those of a joint that slides", "required (URDF: its own)",
         "`[0, 1200]`"},
        {"repeatability_mrad", "",
         "standard deviation about where it was sent, of a joint that turns", "0", "`0.01`"},
        {"repeatability_mm", "", "that of a joint that slides", "0", "`0.02`"},
        {"pitch_mm", "",
         "of a joint that slides: how far it moves until the error of its drive repeats (lead of "
         "a screw, circumference of a pinion, pitch of a rack's teeth). With it the slide has "
         "harmonics. A pitch beyond the range leaves less than a period there, which only a prior "
         "tells from offset and scale",
         "unknown: no harmonics", "`20`"},
    }};

const YamlKeys dh{"dh",
                  {
                      {"convention", "",
                       "`standard`: RotZ(theta) TransZ(d) TransX(a) RotX(alpha) RotY(beta); "
                       "`modified`: RotX TransX RotZ TransZ",
                       "required", "`standard`"},
                      {"rows", "", "from base to flange", "required", "below"},
                  }};

const YamlKeys row{
    "row",
    {
        {"a_mm", "", "length along x", "required", "`612`"},
        {"alpha_deg", "", "angle about x", "required", "`90`"},
        {"d_mm", "", "length along z", "required", "`127.3`"},
        {"theta_deg", "", "angle about z", "required", "`0`"},
        {"beta_deg", "",
         "angle about y, only of the standard convention: for axes that are nearly parallel, with "
         "`d_mm: 0` (Hayati)",
         "0", "`0.02`"},
        {"joint", "", "name of the joint that drives the row", "none: the row is fixed", "`q1`"},
        {"kind", "", "`revolute` (drives theta) or `prismatic` (drives d)", "`revolute`",
         "`prismatic`"},
        {"drive", "", "the joint as it acts: reversed, coupled", "the joint itself", "`-q3 + q2`"},
        {"limits_deg", "", "as of a joint", "required with `joint`", "`[-360, 360]`"},
        {"limits_mm", "", "as of a joint", "required with a prismatic `joint`", "`[0, 800]`"},
        {"repeatability_mrad", "", "as of a joint", "0", "`0.01`"},
        {"repeatability_mm", "", "as of a joint", "0", "`0.02`"},
        {"pitch_mm", "", "as of a joint", "unknown: no harmonics", "`20`"},
    }};

const YamlKeys terms{
    "terms",
    {
        {"direction", "gravity and compliance", "that of gravity in the base frame", "`[0, 0, -1]`",
         "`[0, 0, 1]`"},
        {"joints", "",
         "which joints have these errors; not of `gravity` with `errors: full`, which has them on "
         "all",
         "all that can", "`[q2, q3]`"},
        {"orders", "harmonics and axis_tilt",
         "harmonics a turn (of a slide a turn of its drive): a list, or a range of whole ones",
         "required", "`1..40`"},
        {"links", "compliance",
         "weight of the link after each joint, or `urdf` for the masses of the URDF", "none",
         "`{q2: {mass_kg: 8, center_mm: [0, 0, 200]}}`"},
        {"payload", "compliance", "weight in the flange frame", "none",
         "`{mass_kg: 5, center_mm: [0, 0, 80]}`"},
        {"torques_Nm", "compliance, instead of weights",
         "the largest torques that occur; those of each sample are columns `tau_q2_Nm` of the "
         "measurements",
         "none", "`{q2: 200, q4: 80}`"},
    }};

const YamlKeys weight{
    "weight",
    {
        {"mass_kg", "", "of a link or the payload", "required", "`8`"},
        {"center_mm", "", "its centre of mass, in the frame after the joint or of the flange",
         "required", "`[0, 0, 200]`"},
    }};

const YamlKeys sensor{
    "sensor",
    {
        {"kind", "", "`points`, `poses`, `camera`, `distances`, `planes` or `sockets`", "required",
         "`points`"},
        {"frame", "points, poses, camera, distances and planes",
         "beside a first one (`sensors`): where its own frame is in that of the first (of a camera "
         "on the flange the board is its frame); `first`: it is the same",
         "unknown: found, but must be stated to plan and to simulate",
         "`{position_mm: [3000, 0, 0], rpy_deg: [0, 0, 90]}`"},
        {"sigma_mm", "points, poses, distances, planes and sockets",
         "standard deviation of one coordinate or length; of points and poses also one for each "
         "axis",
         "this or `noise` is required", "`0.05`, `[0.05, 0.05, 0.1]`"},
        {"noise", "points and poses", "that of a laser tracker at the origin", "",
         "`{range_um: 10, angle_urad: 15}`"},
        {"targets", "points, distances, planes and sockets",
         "what is measured on the flange; of sockets one, the ball", "required", "`{count: 3}`"},
        {"sigma_orientation_mrad", "poses", "each of the three angles", "required", "`0.1`"},
        {"camera", "poses",
         "`flange`: a camera on the flange sees a board that stands still (hand-eye): the tool is "
         "the camera, the base is found in the board's frame; `fixed`: a camera that stands still "
         "sees a board on the flange. `sigma_mm` for each axis is then along those of the camera, "
         "z "
         "being the depth",
         "another instrument", "`flange`"},
        {"camera", "camera",
         "`flange`: the camera is on the flange and the board stands still, base is found in the "
         "board's frame; `fixed`: the camera stands still and the board is on the flange, base is "
         "found in the camera's frame (z forwards, x to the right of the image, y down)",
         "required", "`flange`"},
        {"sigma_px", "camera", "standard deviation of a corner's u and v", "required", "`0.3`"},
        {"noise", "camera", "how it grows with tilt and out of focus, see below",
         "the same anywhere", "`{tilt: 1}`"},
        {"image_px", "camera",
         "width and height: corners outside are refused, and poses planned to show the board "
         "inside",
         "any place", "`[1280, 960]`"},
        {"intrinsics", "camera", "focal lengths, principal point and distortion", "required",
         "`{file: camera.yaml}`"},
        {"board", "camera", "what it shows and where its corners are", "required",
         "`{columns: 9, rows: 6, square_mm: 25}`"},
        {"place", "camera",
         "where the camera (on the flange) or the board (of a fixed camera) is in the flange frame",
         "unknown", "`{position_mm: [0, 40, 80], rpy_deg: [0, 0, 90]}`"},
        {"other_cameras", "camera",
         "further cameras, fixed to the first one, that see the same board; the measurements' "
         "column `camera` counts them from 2",
         "none", "`[{intrinsics: {file: left.yaml}}]`"},
        {"same_camera", "camera",
         "beside an earlier one (`sensors`), its number: the same camera sees another board; "
         "`board`, "
         "`view` and `frame` (of a fixed camera `place`) are then its only keys",
         "another camera", "`1`"},
        {"view", "camera", "when corners count as seen in poses that are planned", "see below",
         "`{most_tilt_deg: 50}`"},
        {"measured", "poses",
         "with `camera`: `board_in_camera`, as solvePnP gives it, or its inverse",
         "`board_in_camera`", "`camera_in_board`"},
        {"tool", "poses", "the body that is measured", "at an unknown place",
         "`{position_mm: [0, 0, 120], rpy_deg: [0, 0, 0]}`"},
        {"anchors", "distances", "where they are measured from", "required",
         "`{position_mm: [[1000, 2000, 0]], known: true}`"},
        {"planes", "planes", "the faces that are touched", "required",
         "`[{normal: [0, 0, 1], offset_mm: 300}]`"},
        {"known_planes", "planes", "whether planes that do not say it themselves are as stated",
         "`false`", "`true`"},
        {"sockets", "sockets", "the places where the ball sits", "required",
         "`[{name: s0}, {name: s1, from: s0, distance_mm: 50}]`"},
        {"known_sockets", "sockets", "whether the sockets are where `position_mm` says", "`false`",
         "`true`"},
    }};

const YamlKeys camera{
    "camera",
    {
        {"fx_px", "intrinsics",
         "focal length along the image's width; 0 or none if unknown: it is "
         "then found from the views",
         "0", "`1210.4`"},
        {"fy_px", "intrinsics", "along its height", "0", "`1211.0`"},
        {"cx_px", "intrinsics", "principal point", "0", "`640`"},
        {"cy_px", "intrinsics", "principal point", "0", "`480`"},
        {"distortion", "intrinsics", "of the lens", "none",
         "`{model: brown_conrady, coefficients: [-0.1, 0.02, 0, 0, 0]}`"},
        {"file", "intrinsics",
         "instead of these: a YAML file of OpenCV (`camera_matrix`, `distortion_coefficients`) or "
         "the first camera of one of Kalibr (`intrinsics`, `distortion_coeffs`), also the size of "
         "its image; relative to the campaign file",
         "none", "`camera.yaml`"},
        {"known", "intrinsics",
         "exact as stated: `true`, `false`, or the names of those that are: fx, fy, cx, cy, k1, "
         "...; all others are found, coefficients that are 0, too, unless `deviations` has them",
         "`true`", "`false`"},
        {"deviations", "intrinsics",
         "standard deviations about their stated values of those that are known so well, by name "
         "(fx_px, fy_px, cx_px, cy_px, k1, ...): their errors are found with the rest; none that "
         "`known` says to be exact, which without `known` all others are",
         "none: they are exact, or not known", "`{fx_px: 2, fy_px: 2, cx_px: 4, cy_px: 4}`"},
        {"model", "distortion",
         "`none`, `brown_conrady` (k1 k2 p1 p2, k3, k4 k5 k6) or `fisheye` (k1 k2 k3 k4), with "
         "OpenCV's formulas",
         "required", "`fisheye`"},
        {"coefficients", "distortion", "4, 5 or 8 of brown_conrady, 4 of fisheye",
         "required but for none", "`[0.01, 0, 0, 0]`"},
        {"intrinsics", "other_cameras", "as of the first camera", "required",
         "`{file: left.yaml}`"},
        {"image_px", "other_cameras", "as of the first camera", "any place", "`[1280, 960]`"},
        {"sigma_px", "other_cameras", "as of the first camera", "the first one's", "`0.3`"},
        {"noise", "other_cameras", "as of the first camera", "the first one's", "`{tilt: 1}`"},
        {"place", "other_cameras",
         "where it is in the first one's frame, roughly, to plan and simulate; found by views that "
         "they share",
         "unknown", "`{position_mm: [120, 0, 0], rpy_deg: [0, 0, 0]}`"},
        {"most_tilt_deg", "view",
         "between a plane board's normal and the line of sight of a corner", "60", "`50`"},
        {"least_corners", "view", "a pose must show", "4", "`20`"},
        {"nearest_mm", "view", "least depth of a corner, along the camera's axis", "0", "`250`"},
        {"farthest_mm", "view", "largest depth of a corner", "any", "`900`"},
        {"line_of_sight", "view", "whether the cell's links and obstacles hide corners", "`true`",
         "`false`"},
        {"front", "view", "the side of a plane board that bears the pattern: `-z` or `+z`", "`-z`",
         "`+z`"},
    }};

const YamlKeys board{
    "board",
    {
        {"kind", "chessboard, charuco, aprilgrid and points",
         "which of these: a chessboard, OpenCV's ChArUco board, Kalibr's grid of AprilTags "
         "(36h11), "
         "or points that stand alone",
         "`points` where `points_mm` is stated, else `chessboard`", "`charuco`"},
        {"columns", "chessboard, charuco and aprilgrid",
         "of a chessboard inner corners in a row, not squares; of a ChArUco board squares; of an "
         "AprilGrid tags",
         "required", "`9`"},
        {"rows", "chessboard, charuco and aprilgrid", "as many rows of these", "required", "`6`"},
        {"square_mm", "chessboard, charuco and file",
         "side of a square; with a `file` of OpenCV, which has no unit, the same in mm",
         "required, not of other files", "`25`"},
        {"marker_mm", "charuco", "side of a marker, with its black border; at most 0.9 of a square",
         "required", "`18`"},
        {"dictionary", "charuco", "of the markers, as OpenCV names it", "`DICT_4X4_50`",
         "`DICT_5X5_100`"},
        {"legacy", "charuco",
         "whether its first square is white, as OpenCV before 4.6 made boards with an even number "
         "of rows",
         "`false`", "`true`"},
        {"tag_mm", "aprilgrid", "side of a tag, with its black border", "required", "`88`"},
        {"spacing", "aprilgrid", "gap between two tags, divided by a tag's side", "required",
         "`0.3`"},
        {"points_mm", "points", "places of its corners or markers, not necessarily in a plane",
         "required", "`[[0, 0, 0], [50, 0, 0], [50, 50, 0], [0, 50, 0]]`"},
        {"file", "file, instead of these",
         "a target file of Kalibr (`target_type: aprilgrid` or `checkerboard`), settings or "
         "results of OpenCV's calibration (`BoardSize_Width` or `board_width`, YAML or XML), or a "
         "YAML file with these keys under `board`; relative to the campaign file",
         "none", "`board.yaml`"},
        {"sigma_mm", "",
         "standard deviation of its corners' or markers' places, each coordinate about the stated "
         "one: their errors are found with the rest",
         "exact", "`0.3`"},
        {"first_point", "", "the first corner's number in the measurements: 0 or 1",
         "1; of charuco and aprilgrid 0", "`0`"},
    }};

const YamlKeys noise{
    "noise",
    {
        {"range_um", "points and poses", "along the beam", "required", "`10`"},
        {"angle_urad", "points and poses", "of each of the two angles", "required", "`15`"},
        {"tilt", "camera",
         "exponent of 1 / cos of the angle between a plane board's normal and "
         "the line of sight, by which a corner's noise grows: 1 as its pattern "
         "is foreshortened, 0.5 as it covers fewer pixels",
         "0: it does not", "`1`"},
        {"focus_mm", "camera", "depth that is in focus", "all depths are", "`600`"},
        {"aperture_mm", "camera",
         "diameter of the lens' aperture, its focal length divided by the f-number",
         "required with `focus_mm`", "`4.5`"},
    }};

const YamlKeys places{
    "places",
    {
        {"count", "targets", "number of targets, all at unknown places", "this or `position_mm`",
         "`3`"},
        {"position_mm", "targets, tool, place, frame, anchors, socket and base",
         "where they are expected (targets, tool and place in the flange frame, anchors and base "
         "in the instrument's, a sensor's frame in that of the first one)",
         "", "`[[0, 0, 50]]`"},
        {"radius_mm", "targets",
         "of points and distances: the ball's, a body that keeps off the cell's obstacles; 0: a "
         "flat mark",
         "19.05", "`6.35`"},
        {"rpy_deg", "tool, place, frame and base",
         "roll, pitch and yaw about the fixed axes x, y and z", "required", "`[0, 0, 180]`"},
        {"known", "targets, tool, place, frame, anchors and base",
         "fixed as stated: `true`, or the axes that are (targets: x, y, z; base: x, y, z, rx, ry, "
         "rz)",
         "`false`", "`[z]`"},
        {"normal", "plane", "away from the face; its length says nothing", "required",
         "`[0, 0, 1]`"},
        {"offset_mm", "plane", "its distance from the origin along the normal", "required",
         "`300`"},
        {"known", "plane", "fixed as stated: `true`, or what of it is: `normal`, `offset`",
         "as `known_planes` says", "`[normal]`"},
        {"name", "socket", "one word, for the measurements' column `socket`", "required", "`s0`"},
        {"from", "socket", "one listed before it, of the same body", "none", "`s0`"},
        {"distance_mm", "socket", "of its centre from that of `from`", "unknown", "`50`"},
    }};

const YamlKeys spread{
    "spread",
    {
        {"length_mm", "", "every length", "1 mm", "`0.5`"},
        {"angle_mrad", "", "every angle", "1 mrad", "`0.7`"},
        {"gravity_mrad", "", "gravity terms and compliances", "1 mrad", "`1`"},
        {"harmonic_mrad", "", "harmonics of joints that turn", "0.15 mrad", "`0.05`"},
        {"slide_harmonic_mm", "", "harmonics of joints that slide", "0.008 mm", "`0.005`"},
        {"tilt_mrad", "", "tilts of axes, `axis_tilt`", "0.05 mrad", "`0.02`"},
        {"gain_mrad", "", "scales of slides (mm a metre) and ratios of gears (mrad a radian)",
         "0.2 mrad", "`0.3`"},
        {"offset_mrad", "", "offsets of joints that turn", "as other angles", "`20`"},
        {"parameters", "", "exceptions by the name of the parameter, with unit", "none",
         "`{Tx1: 2 mm, dq2: 20 mrad}`"},
    }};

const YamlKeys measurements{
    "measurements",
    {
        {"columns", "",
         "`controller`: joint values are those of the controller, in columns of its joints' names "
         "(`J3_deg`), as a pendant or a log shows them. Configurations and programs stay the "
         "model's",
         "`model`", "`controller`"},
        {"mat", "", "what the variables are called", "required for MATLAB files", ""},
        {"observation", "",
         "which `sensor_name` of robot_calibration's messages holds the points, where several do",
         "the only one whose features move", "`camera`"},
    }};

const YamlKeys mat{
    "mat",
    {
        {"joints", "", "samples x joints", "required", "`q`"},
        {"points", "", "one variable a target, samples x 3", "required", "`[p1, p2, p3]`"},
        {"torques", "", "samples x measured torques, N m", "`tau`", "`tau`"},
        {"angle_unit", "", "of joints that turn", "`rad`", "`deg`"},
        {"length_unit", "", "of points and of joints that slide", "`m`", "`mm`"},
    }};

const YamlKeys cell{
    "cell",
    {
        {"margin_deg", "", "kept from the limits of joints that turn", "0", "`2`"},
        {"slide_margin_mm", "", "kept from the limits of joints that slide", "0", "`10`"},
        {"joint_sums", "",
         "sums of joints, or joints of the controller, that have limits of their own", "none",
         "`{q3 - q2: {limits_deg: [-80, 90]}}`"},
        {"fixed", "", "joints that stay", "none", "`{q6: 0 deg}`"},
        {"least_joint_distance_deg", "", "two poses of a plan differ by so much in some joint",
         "5, or 0 without a model error", "`10`"},
        {"target_boxes_mm", "", "every target must lie in one of them", "anywhere",
         "`[{min: [300, -2200, -400], max: [3000, 1800, 2400]}]`"},
        {"safety_distance_mm", "",
         "of links and the balls at the targets from obstacles and each other", "0", "`20`"},
        {"floor_z_mm", "", "nothing below", "none", "`-670`"},
        {"keep_out", "", "obstacles: a list of named solids", "none", "below"},
        {"links", "",
         "the robot's own solids: capsules; without them a warning says that the arm is not kept "
         "off obstacles",
         "none", "below"},
        {"tracker", "", "what the instrument can see", "everything", "below"},
        {"reflectors", "", "from where the targets can be seen", "everywhere", "below"},
        {"home_deg", "", "where the tour of the poses begins", "anywhere",
         "`[0, -30, 0, 0, 0, 0]`"},
        {"speed_deg_per_s", "", "of each joint, for the time of a tour", "1 rad/s (URDF: its own)",
         "`[130, 115, 125, 180, 180, 260]`"},
        {"speed_rad_per_s", "", "the same in rad/s", "", "`[2.3, 2, 2.2, 3.1, 3.1, 4.5]`"},
        {"acceleration_deg_per_s2", "", "of each joint, likewise", "infinite",
         "`[250, 200, 250, 400, 400, 600]`"},
        {"acceleration_rad_per_s2", "", "the same in rad/s^2", "", "`[4, 4, 4, 7, 7, 10]`"},
        {"settle_s", "", "how long the robot swings at each pose before the first sample", "0",
         "`0.5`"},
        {"dwell_s", "",
         "how long the robot stands still for each sample, for the time a plan takes", "0", "`4`"},
        {"target_change_s", "",
         "how long it takes to move the only reflector by hand to another target: a plan's time "
         "has the cheaper of one run for each target and moving it at every pose",
         "0: a reflector each", "`40`"},
        {"stations", "",
         "how many places the instrument is set up at, one after the other; a plan's time has all "
         "poses at each, its accuracy is that of one",
         "1", "`2`"},
        {"station_change_s", "", "how long it takes to set the instrument up at its next station",
         "0", "`1200`"},
    }};

const YamlKeys joint_sum{
    "joint_sum",
    {
        {"limits_deg", "", "least and largest sum of joints that turn", "", "`[-80, 90]`"},
        {"limits_mm", "", "that of joints that slide", "", "`[0, 900]`"},
    }};

const YamlKeys keep_out{
    "keep_out",
    {
        {"name", "", "for messages", "its place in the list", "`fence`"},
        {"box_mm", "", "a box along the axes of the base frame", "",
         "`{min: [900, -600, -670], max: [1700, 600, -100]}`"},
        {"sphere_mm", "", "a sphere", "", "`{center: [4500, -1500, 600], radius: 600}`"},
        {"capsule_mm", "", "a capsule: what is within `radius` of a line", "",
         "`{from: [1300, 0, -100], to: [1300, 0, 150], radius: 120}`"},
        {"half_space", "", "all behind a plane", "",
         "`{point_mm: [0, 2200, 0], normal: [0, -1, 0]}`"},
    }};

const YamlKeys solid{
    "solid",
    {
        {"min", "box", "the corner with the least x, y and z, in the unit of `box_mm`", "required",
         "`[900, -600, -670]`"},
        {"max", "box", "the opposite corner", "required", "`[1700, 600, -100]`"},
        {"center", "sphere", "its centre, in the unit of `sphere_mm`", "required",
         "`[4500, -1500, 600]`"},
        {"from", "capsule", "one end of the line, in the unit of `capsule_mm`", "required",
         "`[1300, 0, -100]`"},
        {"to", "capsule", "the other", "required", "`[1300, 0, 150]`"},
        {"radius", "sphere and capsule", "in the same unit", "required", "`120`"},
        {"point_mm", "half_space", "a point of the plane", "required", "`[0, 2200, 0]`"},
        {"normal", "half_space", "points away from the obstacle", "required", "`[0, -1, 0]`"},
    }};

const YamlKeys link{
    "link",
    {
        {"name", "", "for messages", "\"after ...\"", "`forearm`"},
        {"after", "", "the frame it is fixed to: `base`, `flange`, or that after a joint",
         "required", "`q3`"},
        {"from_mm", "", "one end", "required", "`[-100, 0, 225]`"},
        {"to_mm", "", "the other", "required", "`[900, 0, 225]`"},
        {"radius_mm", "", "", "required", "`170`"},
    }};

const YamlKeys sight{
    "sight",
    {
        {"range_mm", "tracker", "distance of a target from the instrument", "any",
         "`[1500, 8000]`"},
        {"azimuth_deg", "tracker", "direction of a target about the instrument's z axis", "any",
         "`[-60, 30]`"},
        {"elevation_deg", "tracker", "above its x-y plane", "any", "`[-20, 45]`"},
        {"line_of_sight", "tracker", "whether obstacles and links hide targets",
         "`true` where `tracker` or `reflectors` is stated", "`false`"},
        {"acceptance_half_angle_deg", "reflectors", "of the beam from a target's normal", "30 deg",
         "`50`"},
        {"normals", "reflectors", "where each target looks, in the flange frame",
         "seen from everywhere", "`[[1, 0, 0]]`"},
        {"at_least_visible", "reflectors", "targets a pose must show", "all", "`1`"},
    }};

const YamlKeys controller{
    "controller",
    {
        {"joints", "",
         "each joint of the controller as a sum of the robot's joints, with sign, coupling and "
         "zero: a list in the controller's order, or a map of names; a map may leave out some of "
         "J1, J2, ... that are the robot's",
         "the robot's joints", "`{J3: q3 - q2, J4: -q4, J6: q6 + 90 deg}`"},
        {"maker", "", "instead of `joints`: `fanuc`, of a robot with six joints that turn",
         "none is assumed", "`fanuc`"},
        {"j23_factor", "",
         "of `maker: fanuc`: -1, 0 or 1, as the pendant couples J3 with J2: J3 = q3 - factor q2",
         "required with `maker`", "`1`"},
        {"pulses_per_deg", "",
         "encoder pulses of each of the controller's joints, per mm of one that slides, as in the "
         "controller's own parameters; Yaskawa's programs are in pulses",
         "unknown: no program for Yaskawa is written",
         "`[1341.4, 1341.4, 1341.4, 1000, 1000, 622.2]`"},
    }};

const YamlKeys record{
    "record",
    {
        {"operator", "", "who measured", "not stated", "`A. Smith`"},
        {"instrument", "", "what was measured with", "not stated", "`laser tracker AT960`"},
        {"serial", "", "its serial number, or the robot's", "not stated", "`LT-204`"},
        {"date", "", "when", "not stated", "`2026-01-31`"},
        {"temperature_C", "", "in the cell", "not stated", "`21.5`"},
    }};

const std::vector<const YamlKeys*>& all() {
    static const std::vector<const YamlKeys*> tables{
        &file,   &planning,  &robot,    &joint, &dh,     &row,    &terms,        &weight,
        &sensor, &camera,    &board,    &noise, &places, &spread, &measurements, &mat,
        &cell,   &joint_sum, &keep_out, &solid, &link,   &sight,  &controller,   &record};
    return tables;
}

}  // namespace posewise::detail::keys
