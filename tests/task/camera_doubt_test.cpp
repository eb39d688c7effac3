#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/doubts.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using namespace testing;

struct Seen30 {
    Campaign campaign;
    Measurements measured;
};

/// 30 views by a fixed camera, the robot as stated to its usual errors.
Seen30 views_of(CameraSetup setup) {
    setup.corners = chessboard(6, 4, 0.05);
    setup.pattern.kind = BoardPattern::Kind::Chessboard;
    Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    Simulation simulated =
        simulate(campaign, {.pose_count = 30, .repeats = 1, .truth_seed = 2, .seed = 7});
    return {std::move(campaign), std::move(simulated.measurements)};
}

const Seen30& good() {
    static const Seen30 views = views_of(fixed_camera());
    return views;
}

Parameters registered(const Campaign& campaign, const Measurements& measured) {
    return register_base_and_targets(campaign, measured).parameters;
}

Campaign with_setup(const Campaign& campaign, const CameraSetup& setup) {
    Campaign changed = campaign;
    changed.sensor = std::make_shared<CameraSensor>(setup);
    return changed;
}

CameraSetup setup_of(const Campaign& campaign) {
    return dynamic_cast<const CameraSensor&>(*campaign.sensor).setup();
}

TEST(CameraDoubt, IsNoneOfWhatIsRight) {
    const auto& [campaign, measured] = good();
    EXPECT_FALSE(find_camera_doubt(campaign, measured, registered(campaign, measured)));
    EXPECT_FALSE(find_misfit(campaign, measured, registered(campaign, measured)));
}

TEST(CameraDoubt, NamesTheSquaresThatFit) {
    const auto& [campaign, measured] = good();
    CameraSetup wrong = setup_of(campaign);
    for (Vector3d& corner : wrong.corners) corner *= 25.4 / 25;
    const Campaign stated = with_setup(campaign, wrong);
    const auto doubt = find_camera_doubt(stated, measured, registered(stated, measured));
    ASSERT_TRUE(doubt);
    EXPECT_NEAR(doubt->board_factor, 25 / 25.4, 2e-3);
    EXPECT_NEAR(doubt->square, 0.0508, 1e-12);
    EXPECT_LT(doubt->scaled_misfit, doubt->misfit);
}

TEST(CameraDoubt, SaysNothingOfTheBoardWhereSomethingElseIsWrong) {
    const auto& [campaign, measured] = good();
    Measurements in_degrees = measured;
    in_degrees.configurations *= to_radians(1);
    const auto doubt = find_camera_doubt(campaign, in_degrees, registered(campaign, in_degrees));
    if (!doubt || doubt->board_factor == 1) return;
    EXPECT_GT(doubt->board_factor, 0);
    EXPECT_LT(doubt->scaled_misfit, doubt->misfit);
}

/// What is said of a campaign that states these intrinsics as known.
std::string said_of(const Intrinsics& stated) {
    const auto& [campaign, measured] = good();
    CameraSetup setup = setup_of(campaign);
    setup.intrinsics = stated;
    const Campaign wrong = with_setup(campaign, setup);
    const auto misfit = find_misfit(wrong, measured, registered(wrong, measured));
    return misfit ? describe_misfit(wrong, *misfit) : "";
}

TEST(CameraMisfit, NamesIntrinsicsOfAnotherResolution) {
    const Intrinsics right = setup_of(good().campaign).intrinsics;
    for (const double factor : {0.5, 2.0, 1 / 1.25}) {
        Intrinsics scaled = right;
        scaled.fx /= factor;
        scaled.fy /= factor;
        scaled.cx = (right.cx + 0.5) / factor - 0.5;
        scaled.cy = (right.cy + 0.5) / factor - 0.5;
        const std::string said = said_of(scaled);
        const std::string before = "as those of an image ";
        const std::size_t at = said.find(before);
        ASSERT_NE(at, std::string::npos) << factor << ": " << said;
        EXPECT_NEAR(std::stod(said.substr(at + before.size())), factor, 0.01 * factor);
    }
}

TEST(CameraMisfit, NamesIntrinsicsOfAnImageTurnedByAQuarter) {
    const CameraSetup setup = setup_of(good().campaign);
    const Intrinsics right = setup.intrinsics;
    for (const bool is_right : {true, false}) {
        Intrinsics before = right;  // of the image that was turned to become this one
        std::swap(before.fx, before.fy);
        before.cx = is_right ? right.cy : setup.image->y() - 1 - right.cy;
        before.cy = is_right ? setup.image->x() - 1 - right.cx : right.cx;
        const std::string said = said_of(before);
        EXPECT_NE(said.find(is_right ? "turned by a quarter to the right" : "to the left"),
                  std::string::npos)
            << said;
    }
}

TEST(CameraDoubt, NamesTheScatterOfCorners) {
    const auto& [campaign, measured] = good();
    for (const double times : {0.5, 2.0}) {
        CameraSetup other = setup_of(campaign);
        other.sigma *= times;
        const Campaign stated = with_setup(campaign, other);
        const auto doubt = find_camera_doubt(stated, measured, registered(stated, measured));
        ASSERT_TRUE(doubt);
        EXPECT_NEAR(doubt->scatter, setup_of(campaign).sigma, 0.15 * setup_of(campaign).sigma);
        EXPECT_EQ(doubt->sigma, other.sigma);
    }
}

TEST(FindDoubts, NamesTheRowsWhoseJointsComeAViewLate) {
    const auto& [campaign, measured] = good();
    Measurements late = measured;
    const Index last = late.configurations.rows() - 1;
    late.configurations.bottomRows(last) = measured.configurations.topRows(last);
    const auto doubts_of = [&](const Measurements& one) {
        const Parameters at = registered(campaign, one);
        return find_doubts(campaign, one, at,
                           make_metrics(mean_residuals(campaign, at, one), *campaign.sensor));
    };
    EXPECT_FALSE(doubts_of(measured).look.shifted);
    const Doubts doubts = doubts_of(late);
    ASSERT_TRUE(doubts.look.shifted);
    EXPECT_EQ(doubts.look.shifted->first, measured.ids[1]);
    EXPECT_EQ(doubts.look.shifted->shift, -1);
    EXPECT_LT(doubts.look.shifted->after, 0.1 * doubts.look.shifted->before);
    // Both would be looked for elsewhere.
    EXPECT_TRUE(doubts.views.empty());
    EXPECT_FALSE(doubts.camera);
}

TEST(SizeDoubts, NameAMarkerThatIsFarFromItsPlace) {
    Campaign campaign = before_camera(tracked_campaign(fanuc()), camera_before_cube());
    const Measurements measured =
        simulate(campaign, {.pose_count = 20, .repeats = 1, .truth_seed = 2, .seed = 7})
            .measurements;
    CameraSetup wrong = setup_of(campaign);
    wrong.corners[2].x() += 0.02;
    const Campaign stated = with_setup(campaign, wrong);
    CalibrationOptions options;
    options.folds = 0;
    const auto sizes_of = [&](const Campaign& one) {
        return calibrate(one, measured, options).doubts.sizes;
    };
    const auto is_marker = [](const SizeDoubt& doubt) {
        return doubt.parameter.starts_with("board.p");
    };
    EXPECT_TRUE(std::ranges::none_of(sizes_of(campaign), is_marker));
    const auto sizes = sizes_of(stated);
    const auto found = std::ranges::find(sizes, "board.p3.x", &SizeDoubt::parameter);
    ASSERT_NE(found, sizes.end());
    EXPECT_GT(found->times, 5);
    EXPECT_EQ(found->units, &length_units);
}

TEST(Cures, FindIntrinsicsThatAreNotAsStated) {
    const auto& [campaign, measured] = good();
    CameraSetup wrong = setup_of(campaign);
    wrong.intrinsics.cx += 40;
    const Remedy found{"sensor.intrinsics.known: false", true};
    const auto cures_of = [&](const Campaign& one) { return calibrate(one, measured).cures.found; };
    EXPECT_EQ(std::ranges::count(cures_of(campaign), found, &Cure::remedy), 0);
    const std::vector<Cure> cures = cures_of(with_setup(campaign, wrong));
    ASSERT_EQ(std::ranges::count(cures, found, &Cure::remedy), 1);
    EXPECT_EQ(cures.front().remedy, found);
    EXPECT_LT(cures.front().after, 0.6 * cures.front().before);
}

TEST(FindMisfit, NamesTheSideOnWhichACameraIsNot) {
    const auto& [campaign, measured] = good();
    CameraSetup other = setup_of(campaign);
    other.is_on_flange = true;
    const Campaign stated = before_camera(tracked_campaign(fanuc()), other);
    const auto misfit = find_misfit(stated, measured, registered(stated, measured));
    ASSERT_TRUE(misfit);
    ASSERT_TRUE(misfit->on_other_side);
    EXPECT_LT(*misfit->on_other_side, 0.1 * misfit->distance);
    EXPECT_NE(describe_misfit(stated, *misfit).find("that stands still"), std::string::npos);
}

/// Far from where the camera sees the board a robot's errors move corners by any number of pixels.
TEST(FindMisfit, IsNotHiddenByPosesThatShowNoBoard) {
    CameraSetup setup = camera_on_flange();
    setup.corners = chessboard(6, 4, 0.05);
    Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    Measurements measured =
        simulate(campaign, {.pose_count = 20, .repeats = 1, .truth_seed = 2, .seed = 7})
            .measurements;
    measured.configurations.col(2) *= -1;
    const auto misfit = find_misfit(campaign, measured, registered(campaign, measured));
    ASSERT_TRUE(misfit);
    ASSERT_TRUE(misfit->reading);
    EXPECT_EQ(misfit->reading->reversed, std::vector<std::string>{"q3"});
}

/// With unknown intrinsics u and v exchanged fit as well as one of them reversed.
TEST(FindMisfit, NamesNoReadingThatLeavesTheImage) {
    const auto& [campaign, measured] = good();
    CameraSetup unknown = setup_of(campaign);
    unknown.is_known.assign(unknown.intrinsics.names().size(), false);
    const Campaign stated = before_camera(tracked_campaign(fanuc()), unknown);
    Measurements upwards = measured;
    for (Index u = 0; u < upwards.observations.cols(); u += 2) {
        upwards.observations.col(u + 1) = 0.96 - upwards.observations.col(u + 1).array();
    }
    const auto misfit = find_misfit(stated, upwards, registered(stated, upwards));
    ASSERT_TRUE(misfit);
    ASSERT_TRUE(misfit->reading);
    std::vector<std::string> fitting = misfit->reading->as_well;
    fitting.push_back(misfit->reading->words);
    const std::string right = "u, height - v in place of u, v";
    EXPECT_EQ(std::ranges::count(fitting, right), 1);
    for (const std::string& words : fitting) EXPECT_EQ(words.rfind("v", 0), std::string::npos);
}

TEST(CalibrateHandEye, DoesNotUseWhatFitsFarBetterOtherwise) {
    const auto& [campaign, measured] = good();
    const Campaign hand_eye = with_robot(campaign, without_parameters(campaign.robot));
    const Calibration right = calibrate(hand_eye, measured);
    EXPECT_TRUE(right.faults.empty()) << right.faults.front();
    Measurements halved = measured;
    halved.observations *= 0.5;
    EXPECT_FALSE(calibrate(hand_eye, halved).faults.empty());
    CameraSetup wrong = setup_of(campaign);
    for (Vector3d& corner : wrong.corners) corner *= 1.2;
    EXPECT_FALSE(calibrate(with_setup(hand_eye, wrong), measured).faults.empty());
}

TEST(CalibrateHandEye, FindsThatIntrinsicsAreNotAsStated) {
    const auto& [campaign, measured] = good();
    CameraSetup wrong = setup_of(campaign);
    wrong.intrinsics.cx += 40;
    const Campaign hand_eye = with_robot(campaign, without_parameters(campaign.robot));
    const std::vector<Cure> cures = calibrate(with_setup(hand_eye, wrong), measured).cures.found;
    EXPECT_EQ(
        std::ranges::count(cures, Remedy{"sensor.intrinsics.known: false", true}, &Cure::remedy),
        1);
}

TEST(EarlierEstimate, KeepsMarkersWhereTheBoardWasMovedSince) {
    Campaign campaign = before_camera(tracked_campaign(fanuc()), camera_before_cube());
    const Measurements measured =
        simulate(campaign, {.pose_count = 20, .repeats = 1, .truth_seed = 2, .seed = 7})
            .measurements;
    CalibrationOptions options;
    options.folds = 0;
    Earlier earlier{calibrate(campaign, measured, options).estimate,
                    {.is_prior = true, .has_new_targets = true}};
    const Campaign expected = with_earlier(campaign, earlier);
    EXPECT_EQ(expected.prior->covariance.rows(), prior_count(expected));
    EXPECT_NO_THROW(prior_information(expected));
    EXPECT_NEAR(expected.prior->covariance.diagonal().tail<1>()[0], 1e-6, 1e-18);
    options.earlier = earlier;
    const Calibration again = calibrate(campaign, measured, options);
    EXPECT_TRUE(again.is_identified()) << again.estimate.undetermined;
}

TEST(CameraDoubt, NamesAPrincipalPointOfAnotherImage) {
    const auto& [campaign, measured] = good();
    CameraSetup turned = setup_of(campaign);
    std::swap(turned.intrinsics.cx, turned.intrinsics.cy);
    turned.image = Vector2d(1280, 960);
    turned.intrinsics.cx = 200;
    const Campaign stated = with_setup(campaign, turned);
    const auto doubt = find_camera_doubt(stated, measured, registered(stated, measured));
    ASSERT_TRUE(doubt);
    ASSERT_TRUE(doubt->principal_point);
    EXPECT_EQ((*doubt->principal_point)[0], 200);
    EXPECT_EQ(doubt->middle[0], 640);
    EXPECT_TRUE(doubt->is_of_image);
}

TEST(CameraDoubt, NoticesMirroredNumbers) {
    const auto& [campaign, measured] = good();
    Measurements mirrored = measured;
    for (Index k = 0; k < 24; ++k) {
        const Index other = k - k % 6 + 5 - k % 6;
        mirrored.observations.middleCols(2 * k, 2) = measured.observations.middleCols(2 * other, 2);
        mirrored.is_seen.col(k) = measured.is_seen.col(other);
    }
    const auto doubt = find_camera_doubt(campaign, mirrored, registered(campaign, mirrored));
    ASSERT_TRUE(doubt);
    EXPECT_TRUE(doubt->is_seen_from_back);
}

/// Of sample 9 of the good views.
constexpr Index spoilt = 9;
using Spoil = void (*)(Measurements&);

void renumber(Measurements& measured, const std::vector<Index>& meant) {
    const Measurements right = measured;
    for (Index k = 0; k < 24; ++k) {
        const Index other = meant[static_cast<std::size_t>(k)];
        measured.observations.row(spoilt).segment<2>(2 * k) =
            right.observations.row(spoilt).segment<2>(2 * other);
        measured.is_seen(spoilt, k) = right.is_seen(spoilt, other);
    }
}

std::vector<ViewDoubt> doubts_with(Spoil spoil) {
    const auto& [campaign, measured] = good();
    Measurements wrong = measured;
    spoil(wrong);
    const Parameters at = registered(campaign, wrong);
    // Neither the start nor what else is said follows from that view.
    EXPECT_LT((at.sensor - registered(campaign, measured).sensor).cwiseAbs().maxCoeff(), 0.01);
    const Doubts doubts = find_doubts(campaign, wrong, at, {});
    EXPECT_FALSE(doubts.misfit);
    EXPECT_FALSE(doubts.camera);
    EXPECT_TRUE(doubts.places.empty());
    return doubts.views;
}

TEST(ViewDoubts, AreNoneOfWhatIsRight) {
    EXPECT_TRUE(doubts_with([](Measurements&) {}).empty());
}

TEST(ViewDoubts, NameCornersAtOnePlaceOnALineAndScattered) {
    const std::vector<Spoil> spoils{[](Measurements& wrong) {
                                        for (Index k = 1; k < 24; ++k) {
                                            wrong.observations.row(spoilt).segment<2>(2 * k) =
                                                wrong.observations.row(spoilt).head<2>();
                                        }
                                    },
                                    [](Measurements& wrong) {
                                        for (Index k = 0; k < 24; ++k) {
                                            wrong.observations(spoilt, 2 * k + 1) =
                                                0.3 + 0.1 * wrong.observations(spoilt, 2 * k);
                                        }
                                    },
                                    [](Measurements& wrong) {
                                        RandomStream stream(8);
                                        for (Index k = 0; k < 48; ++k)
                                            wrong.observations(spoilt, k) = stream.uniform(0, 0.9);
                                    }};
    for (const Spoil spoil : spoils) {
        const auto views = doubts_with(spoil);
        ASSERT_EQ(views.size(), 1U);
        EXPECT_EQ(views[0].sample, good().measured.ids[spoilt]);
        EXPECT_TRUE(views[0].is_no_board);
        EXPECT_TRUE(views[0].order.empty());
    }
}

TEST(ViewDoubts, NameTheOrderThatFits) {
    const std::vector<Index> seen = targets_seen(good().measured.is_seen.row(spoilt));
    const std::vector<std::pair<Spoil, std::string>> spoils{
        {[](Measurements& wrong) {
             std::vector<Index> meant;
             for (Index k = 0; k < 24; ++k) meant.push_back(23 - k);
             renumber(wrong, meant);
         },
         "from the board's other end"},
        {[](Measurements& wrong) {
             std::vector<Index> meant;
             for (Index k = 0; k < 24; ++k) meant.push_back(k - k % 6 + 5 - k % 6);
             renumber(wrong, meant);
         },
         "in mirrored order"},
        {[](Measurements& wrong) {
             std::vector<Index> meant;
             for (Index k = 0; k < 24; ++k) meant.push_back(k);
             const std::vector<Index> seen = targets_seen(wrong.is_seen.row(spoilt));
             std::swap(meant[static_cast<std::size_t>(seen.front())],
                       meant[static_cast<std::size_t>(seen.back())]);
             renumber(wrong, meant);
         },
         "with " + std::to_string(seen.front() + 1) + " and " + std::to_string(seen.back() + 1) +
             " exchanged"}};
    for (const auto& [spoil, order] : spoils) {
        const auto views = doubts_with(spoil);
        ASSERT_EQ(views.size(), 1U) << order;
        EXPECT_EQ(views[0].sample, good().measured.ids[spoilt]);
        EXPECT_EQ(views[0].order, order);
        EXPECT_EQ(views[0].is_no_board, order.starts_with("with"));
        EXPECT_GT(views[0].distance, 5 * views[0].others);
    }
}

TEST(ViewDoubts, NameAViewFromAnotherPose) {
    const auto views = doubts_with([](Measurements& wrong) {
        wrong.configurations.row(spoilt) = wrong.configurations.row(3);
    });
    ASSERT_EQ(views.size(), 1U);
    EXPECT_EQ(views[0].sample, good().measured.ids[spoilt]);
    EXPECT_FALSE(views[0].is_no_board);
    EXPECT_TRUE(views[0].order.empty());
}

TEST(ViewDoubts, AreFaultsOfLeastSquaresAlone) {
    const auto& [campaign, measured] = good();
    Measurements wrong = measured;
    wrong.observations.row(spoilt).setConstant(0.4);
    CalibrationOptions options;
    options.folds = 0;
    const Calibration by_squares = calibrate(campaign, wrong, options);
    ASSERT_FALSE(by_squares.faults.empty());
    EXPECT_EQ(by_squares.faults.front(),
              "view '" + good().measured.ids[spoilt] + "' contradicts the others");
    options.joint.loss.kind = LossKind::Cauchy;
    const Calibration robust = calibrate(campaign, wrong, options);
    EXPECT_EQ(robust.doubts.views.size(), 1U);
    EXPECT_TRUE(robust.faults.empty()) << robust.faults.front();
}

TEST(CameraDoubt, NamesAMirroredImageWhereTheLensIsFound) {
    const auto& [campaign, measured] = good();
    CameraSetup unknown = setup_of(campaign);
    unknown.is_known.assign(unknown.intrinsics.names().size(), false);
    const Campaign stated = before_camera(tracked_campaign(fanuc()), unknown);
    Parameters at = registered(stated, measured);
    EXPECT_FALSE(find_camera_doubt(stated, measured, at)->focal_lengths);
    const auto& sensor = dynamic_cast<const CameraSensor&>(*stated.sensor);
    at.sensor[sensor.first_intrinsic(0)] *= -1;
    const auto doubt = find_camera_doubt(stated, measured, at);
    ASSERT_TRUE(doubt);
    ASSERT_TRUE(doubt->focal_lengths);
    EXPECT_LT((*doubt->focal_lengths)[0], 0);
}

/// An image of half the size, where the lens is found and only plans need the one that is stated.
TEST(CameraDoubt, NamesFocalLengthsFarFromThoseStated) {
    CameraSetup setup = fixed_camera();
    setup.is_known.assign(setup.intrinsics.names().size(), false);
    const auto& [campaign, measured] = views_of(setup);
    const auto right = find_camera_doubt(campaign, measured, registered(campaign, measured));
    EXPECT_FALSE(right && right->focal_lengths);
    Measurements half = measured;
    half.observations *= 0.5;
    const auto doubt = find_camera_doubt(campaign, half, registered(campaign, half));
    ASSERT_TRUE(doubt);
    const Intrinsics& stated = setup.intrinsics;
    EXPECT_EQ(doubt->stated_focal_lengths, (std::array<double, 2>{stated.fx, stated.fy}));
    EXPECT_NEAR((*doubt->focal_lengths)[0], 0.5 * stated.fx, 0.02 * stated.fx);
}

TEST(PlaceDoubts, NameABoardThatIsTurnedAgainstItsStatedPlace) {
    const auto& [campaign, measured] = good();
    Parameters found = registered(campaign, measured);
    EXPECT_TRUE(find_place_doubts(campaign, found).empty());
    Campaign turned = campaign;
    turned.nominal.sensor[5] += std::numbers::pi / 2;
    const std::vector<PlaceDoubt> doubts = find_place_doubts(turned, found);
    ASSERT_EQ(doubts.size(), 1U);
    EXPECT_EQ(doubts.front().name, "sensor.place");
    EXPECT_GT(doubts.front().turn, 1);
}

TEST(Misfit, NamesImageAxesThatWereExchanged) {
    const auto& [campaign, measured] = good();
    Measurements swapped = measured;
    for (Index k = 0; k < 24; ++k) {
        swapped.observations.col(2 * k) = measured.observations.col(2 * k + 1);
        swapped.observations.col(2 * k + 1) = measured.observations.col(2 * k);
    }
    const auto misfit = find_misfit(campaign, swapped, registered(campaign, swapped));
    ASSERT_TRUE(misfit);
    ASSERT_TRUE(misfit->reading);
    EXPECT_EQ(misfit->reading->words, "v, u in place of u, v");
    EXPECT_NE(describe_misfit(campaign, *misfit).find(" px"), std::string::npos);
    const Doubts doubts = find_doubts(campaign, swapped, registered(campaign, swapped), {});
    EXPECT_TRUE(doubts.misfit && doubts.misfit->reading);
    EXPECT_FALSE(doubts.camera);
    EXPECT_TRUE(doubts.places.empty() && doubts.views.empty());
    EXPECT_TRUE(
        describe_misfit(campaign, *misfit).starts_with("they fit clearly better with v, u"));
}

}  // namespace
}  // namespace posewise
