#include "posewise/measurement/camera_sensor.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "../../src/measurement/board_pose.hpp"
#include "../../src/measurement/camera_model.hpp"
#include "../../src/measurement/differences.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
#include "support/derivative_check.hpp"
#include "support/sensors.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

const Intrinsics pinhole{1210, 1190, 655, 470, Distortion::None, {}};

Intrinsics with_lens(Distortion distortion, std::size_t count) {
    const std::vector<double> numbers =
        distortion == Distortion::Fisheye
            ? std::vector<double>{0.02, -0.01, 0.003, -0.001}
            : std::vector<double>{-0.12, 0.05, 1e-3, -2e-3, 0.01, 0.02, -0.03, 0.004};
    Intrinsics lens = pinhole;
    lens.distortion = distortion;
    lens.coefficients.assign(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count));
    return lens;
}

const std::vector<Intrinsics>& every_lens() {
    static const std::vector<Intrinsics> all{
        pinhole, with_lens(Distortion::BrownConrady, 4), with_lens(Distortion::BrownConrady, 5),
        with_lens(Distortion::BrownConrady, 8), with_lens(Distortion::Fisheye, 4)};
    return all;
}

/// Of cv2.projectPoints() and cv2.fisheye.projectPoints(), OpenCV 4.6, in the order of every_lens()
/// without the first, for three points.
TEST(Camera, SeesPointsWhereOpenCvDoes) {
    const std::vector<Vector3d> points{{0.1, -0.2, 1.5}, {-0.4, 0.3, 1.2}, {0.5, 0.45, 1.1}};
    const std::vector<std::vector<Vector2d>> expected{
        {{655 + 1210 * 0.1 / 1.5, 470 - 1190 * 0.2 / 1.5},
         {655 - 1210 * 0.4 / 1.2, 470 + 1190 * 0.3 / 1.2},
         {655 + 1210 * 0.5 / 1.1, 470 + 1190 * 0.45 / 1.1}},
        {{735.3567473251029, 311.86359341563787},
         {258.30202128343615, 762.5024418885031},
         {1182.7090918482345, 938.3340226193876}},
        {{735.356756177412, 311.86357600365795},
         {258.2809157338641, 762.5180094116379},
         {1182.996740490978, 938.5886273271383}},
        {{735.3222022612031, 311.93154155785396},
         {259.3023467093166, 761.7645985475127},
         {1181.1538031309074, 936.9573993001666}},
        {{735.1116683998225, 312.42498281687796},
         {271.7396534476713, 752.6940985933498},
         {1151.1932833017868, 909.192567286127}}};
    for (std::size_t lens = 0; lens < expected.size(); ++lens) {
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Vector2d seen = project(every_lens()[lens], points[k]);
            EXPECT_LT((seen - expected[lens][k]).norm(), 1e-9) << lens << ' ' << k;
        }
    }
}

TEST(Camera, HasTheDerivativesOfItsProjectionByPointAndParameters) {
    for (const Intrinsics& lens : every_lens()) {
        SCOPED_TRACE(lens.coefficients.size());
        RandomStream stream(51);
        for (Index item = 0; item < 20; ++item) {
            const Vector3d point = Vector3d(0, 0, 1.5) + random_vector(stream, 3, 0.6);
            Projection projection;
            differentiate_projection(lens_of(lens), point, projection);
            const VectorXd values = lens.values();
            VectorXd both(3 + values.size());
            both << point, values;
            MatrixXd J(2, both.size());
            J << projection.by_point, projection.by_values;
            expect_is_jacobian(
                J,
                [&](const VectorXd& x) -> VectorXd {
                    return 1e-3 * project(lens.with(x.tail(values.size())), x.head<3>());
                },
                both);
        }
    }
}

TEST(Camera, HasTheRatesOfItsDerivativesWhileThePointMoves) {
    for (const Intrinsics& intrinsics : every_lens()) {
        for (const double widest : {1e3, 0.3}) {  // also beyond the widest direction
            Lens lens = lens_of(intrinsics);
            lens.widest = widest;
            for (std::uint64_t item = 0; item < 20; ++item) {
                RandomStream stream(76, item);
                const Vector3d point = random_vector(stream, 3, 0.6) + Vector3d(0, 0, 1.5);
                if (std::abs(point.head<2>().norm() / point.z() - widest) < 0.02) continue;
                const Vector3d velocity = random_vector(stream, 3, 1);
                const auto derivatives = [&](double time) -> MatrixXd {
                    Projection projection;
                    differentiate_projection(lens, point + time * velocity, projection);
                    MatrixXd both(2, 3 + projection.by_values.cols());
                    both << projection.by_point, projection.by_values;
                    return both;
                };
                Projection projection;
                ProjectionRate rate;
                differentiate_projection_along(lens, point, velocity, projection, rate);
                MatrixXd both(2, 3 + rate.by_values.cols());
                both << rate.by_point, rate.by_values;
                const MatrixXd expected = slope_at_zero(1e-3, derivatives);
                EXPECT_LE((both - expected).norm(), 1e-8 * (1 + expected.norm()));
                EXPECT_EQ(projection.place, place_of(lens, point));
            }
        }
    }
}

TEST(Camera, UndistortsWhatItDistorts) {
    for (const Intrinsics& lens : every_lens()) {
        RandomStream stream(52);
        for (Index item = 0; item < 100; ++item) {
            const Vector2d direction = random_vector(stream, 2, 0.5);
            const auto found = undistort(lens, project(lens, {direction.x(), direction.y(), 1}));
            ASSERT_TRUE(found);
            EXPECT_LT((*found - direction).norm(), 1e-10);
        }
    }
}

TEST(Camera, HasNoDirectionForPlacesBeyondWhereTheImageFolds) {
    Intrinsics lens = pinhole;
    lens.distortion = Distortion::BrownConrady;
    lens.coefficients = {-0.4, 0, 0, 0};  // r (1 - 0.4 r^2) is largest at 0.913, 0.609
    EXPECT_NEAR(widest_tangent(lens_of(lens)), 0.913, 0.02);
    EXPECT_TRUE(undistort(lens, {655 + 1210 * 0.6, 470}));
    EXPECT_FALSE(undistort(lens, {655 + 1210 * 0.62, 470}));
}

/// The board's corners somewhere before the camera, leaning.
Isometry3d somewhere(RandomStream& stream) {
    Isometry3d pose(rotation_from_vector(random_vector(stream, 3, 0.6)));
    pose.translation() = Vector3d(-0.1, -0.07, 0.7) + random_vector(stream, 3, 0.1);
    return pose;
}

BoardView view_of(const std::vector<Vector3d>& corners, const Intrinsics& lens,
                  const Isometry3d& pose) {
    BoardView view{corners, {}};
    for (const Vector3d& corner : corners) view.pixels.push_back(project(lens, pose * corner));
    return view;
}

TEST(BoardPose, IsFoundFromCornersInAPlaneAndFromOthers) {
    const std::vector<Vector3d> solid{{0, 0, 0},      {0.2, 0, 0},     {0, 0.15, 0.02},
                                      {0.1, 0, 0.12}, {0.2, 0.2, 0.1}, {0.05, 0.1, 0.2},
                                      {0.1, 0.1, 0.1}};
    for (const auto& corners : {chessboard(5, 4, 0.04), chessboard(2, 2, 0.1), solid}) {
        for (const Intrinsics& lens : every_lens()) {
            RandomStream stream(53);
            for (Index item = 0; item < 20; ++item) {
                const Isometry3d pose = somewhere(stream);
                const auto found = find_board(view_of(corners, lens, pose), lens);
                ASSERT_TRUE(found);
                EXPECT_LT((found->board.matrix() - pose.matrix()).norm(), 1e-8);
                EXPECT_LT(found->rms, 1e-6);
            }
        }
    }
}

TEST(BoardPose, NeedsFourCornersNotInLine) {
    const BoardView view =
        view_of(chessboard(4, 2, 0.04), pinhole, Isometry3d(Eigen::Translation3d(0, 0, 1)));
    const BoardView row{{view.corners.begin(), view.corners.begin() + 4},
                        {view.pixels.begin(), view.pixels.begin() + 4}};
    EXPECT_FALSE(find_board(row, pinhole));
    const BoardView three{{view.corners.begin() + 2, view.corners.begin() + 5},
                          {view.pixels.begin() + 2, view.pixels.begin() + 5}};
    EXPECT_FALSE(find_board(three, pinhole));
}

std::vector<BoardView> several_views(const Intrinsics& lens, Index count) {
    RandomStream stream(54);
    std::vector<BoardView> views;
    for (Index k = 0; k < count; ++k) {
        views.push_back(view_of(chessboard(8, 6, 0.03), lens, somewhere(stream)));
    }
    return views;
}

TEST(Intrinsics, FollowFromViewsAndNothingElse) {
    for (const Intrinsics& lens : every_lens()) {
        if (lens.coefficients.size() == 8) continue;  // k4 to k6 hardly differ from k1 to k3
        SCOPED_TRACE(lens.coefficients.size());
        const Intrinsics nothing = lens.with(VectorXd::Zero(lens.values().size()));
        const std::vector<bool> unknown(nothing.names().size(), false);
        const auto found = find_intrinsics(several_views(lens, 10), nothing, unknown, {});
        ASSERT_TRUE(found);
        EXPECT_LT((found->values() - lens.values()).cwiseAbs().maxCoeff(), 1e-6);
    }
}

TEST(Intrinsics, DoNotFollowFromOneViewWithoutTheImagesMiddle) {
    const Intrinsics nothing = pinhole.with(VectorXd::Zero(4));
    EXPECT_FALSE(find_intrinsics({}, nothing, {false, false, false, false}, {}));
    EXPECT_TRUE(find_intrinsics(several_views(pinhole, 1), nothing, {false, false, false, false},
                                Vector2d(1310, 940)));
}

/// Few views of few corners that are not exactly where they are stated fit far from the truth best.
TEST(Intrinsics, ThatAreStatedAndFitAreKept) {
    const std::vector<Vector3d> stated{{0, 0, 0},         {0.03, 0, 0.01},    {-0.02, 0.03, 0.01},
                                       {-0.02, -0.03, 0}, {0.04, 0.04, 0.03}, {-0.05, 0, 0.03}};
    RandomStream stream(55);
    std::vector<BoardView> views;
    for (Index k = 0; k < 10; ++k) {
        std::vector<Vector3d> true_corners;
        for (const Vector3d& corner : stated) {
            true_corners.push_back(corner + random_vector(stream, 3, 5e-4));
        }
        BoardView view = view_of(true_corners, pinhole, somewhere(stream));
        view.corners = stated;
        views.push_back(std::move(view));
    }
    const std::vector<bool> unknown(4, false);
    EXPECT_EQ(find_intrinsics(views, pinhole, unknown, {})->values(), pinhole.values());
    VectorXd wrong = pinhole.values();
    wrong.head<2>() *= 2;
    const auto found =
        find_intrinsics(several_views(pinhole, 10), pinhole.with(wrong), unknown, {});
    EXPECT_LT((found->values() - pinhole.values()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(CameraSensor, SeesCornersBeforeItWithinItsImageFromTheFront) {
    CameraSetup setup = fixed_camera();
    setup.intrinsics = pinhole;
    setup.known_place = Isometry3d::Identity();
    setup.corners = chessboard(2, 2, 0.1);
    const auto seen = [&](const Isometry3d& pose) -> Eigen::Array<bool, Eigen::Dynamic, 1> {
        VectorXd clearances(4);
        CameraSensor(setup).view_clearances(pose, VectorXd(), clearances);
        return clearances.array() >= 0;
    };
    const Isometry3d ahead(Eigen::Translation3d(-0.05, -0.05, 1));
    EXPECT_TRUE(seen(ahead).all());
    EXPECT_FALSE(seen(Isometry3d(Eigen::Translation3d(-0.05, -0.05, -1))).any());  // behind it
    const Isometry3d at_edge(Eigen::Translation3d(0.45, -0.05, 1));  // u 1199.5 and 1320.5
    EXPECT_EQ(seen(at_edge).count(), 2);
    const Isometry3d turned = ahead * Eigen::Translation3d(0, 0.1, 0) *
                              Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX());
    EXPECT_FALSE(seen(turned).any());  // its back
    setup.view.is_front_plus_z = true;
    EXPECT_TRUE(seen(turned).all());
    setup.view.is_front_plus_z = false;
    const auto leaning = [&](double angle) {
        return ahead * Eigen::AngleAxisd(angle, Vector3d::UnitX());
    };
    EXPECT_TRUE(seen(leaning(0.95)).all());
    EXPECT_FALSE(seen(leaning(1.2)).any());
}

TEST(CameraSensor, IsPlannedWhereItSeesEnoughCorners) {
    CameraSetup setup = fixed_camera();
    setup.corners = chessboard(6, 4, 0.06);
    setup.view.least_corners = 10;
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    const Constraints constraints(campaign, campaign.cell);
    const Pool pool = make_pool(constraints, 3000, 1);
    ASSERT_GT(pool.configurations.rows(), 20);
    ASSERT_LT(pool.configurations.rows(), 1500);
    const CameraSensor& sensor = dynamic_cast<const CameraSensor&>(*campaign.sensor);
    Index parts = 0;
    for (Index i = 0; i < pool.configurations.rows(); ++i) {
        const Isometry3d flange =
            world_from_flange(campaign, campaign.nominal, pool.configurations.row(i).transpose());
        const Isometry3d board = sensor.camera_from_board(flange, campaign.nominal.sensor);
        EXPECT_GE(pool.is_seen.row(i).count(), 10);
        parts += pool.is_seen.row(i).all() ? 0 : 1;
        for (const Index k : targets_seen(pool.is_seen.row(i))) {
            const Vector3d corner = board * setup.corners[static_cast<std::size_t>(k)];
            EXPECT_GT(corner.z(), 0);
            const Vector2d place = project(setup.intrinsics, corner);
            EXPECT_TRUE((place.array() >= 0).all() && place.x() <= 1280 && place.y() <= 960);
            EXPECT_GT(board.linear().col(2).dot(corner), 0) << "its back";
        }
    }
    EXPECT_GT(parts, 0) << "poses may show a part of the board";
    EXPECT_GT(pool.rejections[static_cast<std::size_t>(Constraint::View)].in_all, 1000);
}

TEST(CameraSensor, SeesCornersBetweenItsDepthsOnly) {
    CameraSetup setup = fixed_camera();
    setup.intrinsics = pinhole;
    setup.known_place = Isometry3d::Identity();
    setup.view.nearest = 0.8;
    setup.view.farthest = 1.5;
    const auto clearance = [&](double depth) {
        VectorXd clearances(12);
        CameraSensor(setup).view_clearances(Isometry3d(Eigen::Translation3d(-0.05, -0.05, depth)),
                                            VectorXd(), clearances);
        return clearances[0];
    };
    EXPECT_NEAR(clearance(0.75), -0.05, 1e-12);
    EXPECT_NEAR(clearance(0.85), 0.05, 1e-12);
    EXPECT_NEAR(clearance(1.49), 0.01, 1e-12);
    EXPECT_NEAR(clearance(1.6), -0.1, 1e-12);
}

TEST(CameraSensor, IsNoisierWhereTheBoardIsTiltedAndOutOfFocus) {
    CameraSetup setup = fixed_camera();
    setup.intrinsics = pinhole;
    setup.corners = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
    setup.known_place = Isometry3d::Identity();
    setup.sigma = 0.3;
    const auto sigma_at = [&](double tilt, double depth) {
        const Isometry3d pose =
            Eigen::Translation3d(0, 0, depth) * Eigen::AngleAxisd(tilt, Vector3d::UnitX());
        const MatrixXd covariance = CameraSensor(setup).covariance(pose, VectorXd());
        EXPECT_EQ(covariance(0, 0), covariance(1, 1));
        EXPECT_TRUE(covariance.isDiagonal(0));
        return 1e3 * std::sqrt(covariance(0, 0));  // of the corner at the board's origin
    };
    EXPECT_EQ(sigma_at(0.5, 1), 0.3);
    setup.growth.tilt = 1;
    EXPECT_NEAR(sigma_at(0, 1), 0.3, 1e-15);
    EXPECT_NEAR(sigma_at(std::numbers::pi / 3, 1), 0.6, 1e-12);
    EXPECT_NEAR(sigma_at(1.57, 1), 0.3 / 0.05, 1e-12) << "no more than that";
    setup.growth.tilt = 0.5;
    EXPECT_NEAR(sigma_at(std::numbers::pi / 3, 1), 0.3 * std::sqrt(2.0), 1e-12);
    setup.growth = {0, 0.5, 4e-3};
    EXPECT_NEAR(sigma_at(1, 0.5), 0.3, 1e-15);
    const double blur = 1210 * 4e-3 * (1 / 0.5 - 1 / 0.8);
    EXPECT_NEAR(sigma_at(1, 0.8), 0.3 * std::hypot(1, blur), 1e-12);
    EXPECT_FALSE(CameraSensor(setup).has_constant_covariance());
    std::vector<std::string> names;
    for (const NoiseNumber& one : CameraSensor(setup).noise_numbers()) names.push_back(one.name);
    EXPECT_EQ(names, (std::vector<std::string>{"sigma_px", "focus_m", "aperture_m"}));
}

TEST(CameraSensor, SeesNothingBehindLinksAndObstaclesUnlessTold) {
    CameraSetup setup = fixed_camera();
    setup.view.least_corners = 10;
    Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    const Isometry3d base_from_world = campaign.nominal.world_from_base.inverse();
    const Pool free = make_pool(Constraints(campaign, campaign.cell), 3000, 1);
    Cell cell = campaign.cell;
    // A pole between camera and robot, and a sphere about the camera, which does not blind it.
    const Vector3d pole = base_from_world * Vector3d(0.1, 0, 1);
    cell.keep_outs.push_back({"pole", Sphere{pole, 0.1}});
    cell.keep_outs.push_back({"housing", Sphere{base_from_world.translation(), 0.2}});
    const Constraints constraints(campaign, cell);
    const Pool pool = make_pool(constraints, 3000, 1);
    EXPECT_LT(pool.configurations.rows(), free.configurations.rows());
    EXPECT_GT(pool.configurations.rows(), 10);
    const auto& sensor = dynamic_cast<const CameraSensor&>(*campaign.sensor);
    Index hidden = 0;
    for (Index i = 0; i < free.configurations.rows(); ++i) {
        const VectorXd q = free.configurations.row(i).transpose();
        const Isometry3d board = sensor.camera_from_board(
            world_from_flange(campaign, campaign.nominal, q), campaign.nominal.sensor);
        const SeenTargets seen = constraints.seen(q);
        for (Index k = 0; k < 12; ++k) {
            const Vector3d corner = board * setup.corners[static_cast<std::size_t>(k)];
            const Vector3d center(0.1, 0, 1), way = corner.normalized();
            const double nearest = std::clamp(center.dot(way), 0.0, corner.norm() - 0.02);
            const bool passes = (center - nearest * way).norm() >= 0.1;
            EXPECT_EQ(seen[k], passes && free.is_seen(i, k));
            hidden += passes ? 0 : 1;
        }
    }
    EXPECT_GT(hidden, 50);
    // So it is beside a tracker, whose frame is another one.
    const Campaign both = combined_campaign(tracked_campaign(fanuc()), {campaign});
    const Constraints of_both(both, cell);
    for (Index i = 0; i < pool.configurations.rows(); ++i) {
        const SeenTargets seen = of_both.seen(pool.configurations.row(i).transpose());
        EXPECT_TRUE((seen.tail(12) == pool.is_seen.row(i)).all());
        EXPECT_TRUE(seen.head(seen.size() - 12).all());
    }
    VectorXd clearances = VectorXd::Ones(both.sensor->target_count());
    clearances.tail<3>().setConstant(-0.1);  // 9 of 12 are left
    both.sensor->hide_incomplete_parts(clearances);
    EXPECT_EQ(clearances.tail<12>(), VectorXd::Constant(12, -0.1));
    EXPECT_EQ(clearances.head(clearances.size() - 12).minCoeff(), 1);
    setup.view.is_line_required = false;
    campaign.sensor = std::make_shared<CameraSensor>(setup);
    EXPECT_EQ(make_pool(Constraints(campaign, cell), 3000, 1).configurations, free.configurations);
}

/// What is fixed to the flange and holds the camera, or to the table and holds the board.
TEST(CameraSensor, LooksOutOfWhatHoldsIt) {
    for (const bool is_on_flange : {true, false}) {
        CameraSetup setup = is_on_flange ? camera_on_flange() : fixed_camera();
        setup.view.least_corners = 10;
        const Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
        const Pool free = make_pool(Constraints(campaign, campaign.cell), 4000, 1);
        const Isometry3d base_from_world = campaign.nominal.world_from_base.inverse();
        Cell cell = campaign.cell;
        cell.links.push_back({"holder", 7, Capsule{{0, 0, 0}, {0.1, -0.05, 0.2}, 0.05}});
        cell.keep_outs.push_back({"table", Sphere{base_from_world.translation(), 0.15}});
        const Pool held = make_pool(Constraints(campaign, cell), 4000, 1);
        EXPECT_EQ(held.configurations, free.configurations) << is_on_flange;
        EXPECT_TRUE((held.is_seen == free.is_seen).all());
        cell.links.front() = {"arm", 5, Capsule{{0, 0, -0.5}, {0, 0, 0.5}, 0.5}};
        EXPECT_THROW(make_pool(Constraints(campaign, cell), 4000, 1), InputError);
    }
}

/// Noise and what the model cannot express move corners over its edge.
TEST(CameraSensor, ReadsNothingOutsideOfItsImage) {
    CameraSetup setup = fixed_camera();
    setup.sigma = 20;
    setup.view.least_corners = 4;
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    const Measurements measured =
        simulate(campaign, {.pose_count = 100, .repeats = 2}).measurements;
    Index lost = 0;
    for (Index sample = 0; sample < measured.is_seen.rows(); ++sample) {
        const VectorXd observation = measured.observations.row(sample).transpose();
        for (Index corner = 0; corner < measured.is_seen.cols(); ++corner) {
            const Vector2d px = 1e3 * observation.segment<2>(2 * corner);
            const bool is_inside = px.minCoeff() >= 0 && px.x() <= 1280 && px.y() <= 960;
            EXPECT_EQ(campaign.sensor->is_readable(corner, observation), is_inside);
            EXPECT_TRUE(is_inside || !measured.is_seen(sample, corner)) << px.transpose();
            lost += !is_inside && !measured.is_seen(sample, corner) ? 1 : 0;
        }
    }
    EXPECT_GT(lost, 20);
}

TEST(CameraSensor, IsNotPlannedWhereNobodyKnowsWhatItSees) {
    Campaign campaign = before_camera(tracked_campaign(fanuc()), fixed_camera());
    campaign.has_nominal_targets = false;
    EXPECT_THROW(Constraints(campaign, campaign.cell), InputError);
    EXPECT_NO_THROW(Constraints(campaign, campaign.cell, false));
}

TEST(CameraSensor, HasTheDerivativeByTheSizeOfItsBoard) {
    for (CameraSetup setup : {fixed_camera(), camera_on_flange(), camera_before_cube()}) {
        setup.is_scale_unknown = true;
        const CameraSensor sensor(setup);
        Isometry3d place(Eigen::AngleAxisd(0.4, Vector3d(1, -2, 0.5).normalized()));
        place.translation() = Vector3d(0.1, -0.05, 0.2);
        Isometry3d flange(Eigen::Translation3d(0.1, 0.2, 1.5) *
                          Eigen::AngleAxisd(0.3, Vector3d::UnitX()));
        if (setup.is_on_flange) flange = flange.inverse();
        VectorXd unknowns = sensor.unknowns(place, setup.intrinsics);
        unknowns[unknowns.size() - 1] = 0.02;
        RowMatrixXd J(sensor.row_count(), unknowns.size());
        sensor.differentiate(flange, TwistMatrix(6, 0), unknowns, J);
        expect_is_jacobian(
            J, [&](const VectorXd& x) { return sensor.predict(flange, x); }, unknowns);
        EXPECT_EQ(sensor.unknown_names().back(), "board.scale");
        EXPECT_EQ(sensor.unknown_units().back(), &plain_units);
    }
}

TEST(CameraSensor, NamesErrorsOfItsCornersFirst) {
    CameraSetup setup = camera_before_cube();
    setup.first_corner = 0;
    const CameraSensor sensor(setup);
    const auto names = sensor.unknown_names();
    ASSERT_EQ(names.size(), 30u);
    EXPECT_EQ(names.front(), "board.p0.x");
    EXPECT_EQ(names[23], "board.p7.z");
    EXPECT_EQ(names[24], "board.x");
    EXPECT_EQ(sensor.unknown_units()[23], &length_units);
    EXPECT_EQ(sensor.unknown_units()[27], &angle_units);
    EXPECT_EQ(sensor.unknown_sizes(), VectorXd::Constant(24, 1e-3));
    VectorXd unknowns = VectorXd::Zero(30);
    unknowns.segment<3>(24) = Vector3d(1, 2, 3);
    EXPECT_EQ(sensor.targets().position(0, unknowns), Vector3d(1, 2, 3));
}

TEST(CameraSensor, SeesTheBoardFromWhereEachCameraIs) {
    const CameraSetup setup = three_cameras();
    const CameraSensor sensor(setup);
    const CameraSensor alone(fixed_camera());
    const auto others = beside_first(setup);
    Isometry3d place(Eigen::AngleAxisd(0.4, Vector3d(1, -2, 0.5).normalized()));
    const Isometry3d flange(Eigen::Translation3d(0.1, 0.2, 2.5) *
                            Eigen::AngleAxisd(0.3, Vector3d::UnitX()));
    const VectorXd all = sensor.predict(flange, sensor.unknowns(place, setup.intrinsics, others));
    for (Index c = 0; c < 3; ++c) {
        const Isometry3d in_first =
            c == 0 ? Isometry3d::Identity() : others[static_cast<std::size_t>(c - 1)].in_first;
        const VectorXd one =
            alone.predict(in_first.inverse() * flange, alone.unknowns(place, setup.intrinsics));
        EXPECT_LT((all.segment(24 * c, 24) - one).cwiseAbs().maxCoeff(), 1e-12);
    }
    const MatrixXd covariance = sensor.covariance(flange, VectorXd::Zero(27));
    EXPECT_NEAR(covariance(30, 30), 4 * covariance(3, 3), 1e-20);
    const auto names = sensor.unknown_names();
    EXPECT_EQ(names[6], "camera2.x");
    EXPECT_EQ(names[18], "camera3.fx");
    EXPECT_EQ(names.size(), 27u);
    EXPECT_EQ(sensor.unknown_units()[6], &length_units);
    EXPECT_EQ(sensor.unknown_units()[9], &angle_units);
    EXPECT_EQ(sensor.unknown_units()[18], &pixel_units);
    EXPECT_EQ(sensor.observation_names()[24], "c2_p1_u");
}

TEST(CameraSensor, NamesUnknownsWithTheirUnits) {
    const CameraSensor sensor(camera_on_flange());
    EXPECT_EQ(
        sensor.unknown_names(),
        (std::vector<std::string>{"camera.x", "camera.y", "camera.z", "camera.rx", "camera.ry",
                                  "camera.rz", "camera.fx", "camera.fy", "camera.cx", "camera.k1",
                                  "camera.k2", "camera.k3", "camera.k4"}));
    const auto units = sensor.unknown_units();
    EXPECT_EQ(units[2], &length_units);
    EXPECT_EQ(units[3], &angle_units);
    EXPECT_EQ(units[8], &pixel_units);
    EXPECT_EQ(units[9], &plain_units);
    EXPECT_EQ(sensor.units(true).error, "px");
}

TEST(CameraSensor, RefusesWhatIsNoCamera) {
    const auto refuses = [](const auto& change) {
        CameraSetup setup = fixed_camera();
        change(setup);
        EXPECT_THROW(CameraSensor{setup}, InputError);
    };
    refuses([](CameraSetup& s) { s.corners.resize(3); });
    refuses([](CameraSetup& s) { s.corners = chessboard(5, 1, 0.1); });
    refuses([](CameraSetup& s) { s.sigma = 0; });
    refuses([](CameraSetup& s) { s.corner_sigma = -1e-3; });
    refuses([](CameraSetup& s) { s.corner_sigma = NAN; });
    refuses([](CameraSetup& s) {
        s.others = {s};
        s.others[0].intrinsics.fy = -1;
    });
    refuses([](CameraSetup& s) { s.intrinsics.fx = 0; });
    refuses([](CameraSetup& s) { s.intrinsics.cx = NAN; });
    refuses([](CameraSetup& s) { s.intrinsics.coefficients.resize(6); });
    refuses([](CameraSetup& s) { s.is_known = {true, false}; });
    refuses([](CameraSetup& s) { s.corners[1].x() = INFINITY; });
    refuses([](CameraSetup& s) { s.growth.tilt = -1; });
    refuses([](CameraSetup& s) { s.growth = {0, 0.0, 4e-3}; });
    refuses([](CameraSetup& s) { s.growth = {0, 0.5, 0}; });
    refuses([](CameraSetup& s) { s.view.nearest = s.view.farthest = 1; });
    refuses([](CameraSetup& s) {
        s = camera_before_cube();
        s.growth.tilt = 1;
    });
}

}  // namespace
}  // namespace posewise
