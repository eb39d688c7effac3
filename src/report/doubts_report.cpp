#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "residual_look_report.hpp"
#include "sentences.hpp"

namespace posewise {
namespace {

/// "dq2 (70 mrad, 3.5 times)".
std::string list_sizes(const std::vector<SizeDoubt>& sizes, bool has_values) {
    std::string words;
    for (const SizeDoubt& size : sizes) {
        words += (words.empty() ? "" : ", ") + size.parameter + " (";
        if (has_values) words += detail::format_error(size.value, *size.units) + ", ";
        words += detail::format_short(size.times, 3) + " times)";
    }
    return words;
}

/// A prior holds values back.
std::string describe_sizes(bool has_prior, const std::vector<SizeDoubt>& sizes) {
    constexpr std::size_t shown = 5;
    std::vector<SizeDoubt> largest = sizes;
    std::ranges::stable_sort(largest, std::greater{}, &SizeDoubt::times);
    largest.resize(std::min(shown, largest.size()));
    std::string words = list_sizes(largest, has_prior);
    if (sizes.size() > shown) words += fmt::format(" and {} more", sizes.size() - shown);
    const bool are_terms = std::ranges::all_of(sizes, &SizeDoubt::is_term);
    const bool are_gains = std::ranges::all_of(sizes, [](const SizeDoubt& size) {
        return size.parameter.ends_with(".scale") || size.parameter.ends_with(".gain");
    });
    const std::string question = are_gains   ? "are pitch or gear ratio in the controller right"
                                 : are_terms ? "does the robot give way that much"
                                             : "are sign, unit and nominal value in the campaign "
                                               "right";
    return fmt::format("{}: {}; {}{}?",
                       has_prior ? "beyond three times the expected size, which holds them back"
                                 : "far above the expected size",
                       words, question, has_prior ? "" : ", and do the poses tell them apart");
}

std::string describe_learned_sizes(const std::vector<SizeDoubt>& sizes) {
    const bool are_terms = std::ranges::all_of(sizes, &SizeDoubt::is_term);
    return fmt::format("sizes of errors were learned far above the expected ones: {}; {}?",
                       list_sizes(sizes, true),
                       are_terms ? "does the robot give way that much"
                                 : "are lengths, units and signs in the campaign right");
}

std::string describe_model_errors(const std::vector<ModelErrorDoubt>& errors) {
    std::string words;
    for (const ModelErrorDoubt& error : errors) {
        words +=
            fmt::format("{}{}{}, {} times what is expected", words.empty() ? "" : " and ",
                        detail::format_error(error.value, error.is_angle),
                        error.is_limit ? " or more" : "", detail::format_short(error.times, 3));
    }
    return fmt::format(
        "the model error found is {}: so much is left over that neither the robot's model nor the "
        "noise stated explains",
        words);
}

/// "base 200 mm and targets 3 mm".
std::string describe_distances(const Moved& moved) {
    std::string distances;
    for (const std::string& part : moved.parts) {
        const double distance = part == "base" ? moved.base : moved.targets;
        distances += fmt::format("{}{} {} mm", distances.empty() ? "" : " and ", part,
                                 detail::format_short(mm_per_m * distance, 3));
    }
    return distances;
}

/// "base 200 mm and targets 3 mm from where EARLIER: OPTION base,targets identifies them anew".
std::string describe_moved(const Moved& moved, const char* earlier, const char* option) {
    return fmt::format("{} from where {}: {} {} identifies {} anew", describe_distances(moved),
                       earlier, option, fmt::join(moved.parts, ","),
                       moved.parts.front() == "base" && moved.parts.size() == 1 ? "it" : "them");
}

std::string describe_scatter(const ScatterDoubt& scatter) {
    return fmt::format(
        "repeated samples scatter {} times as much as sigma says, {} most: is it grossly wrong, or "
        "sigma stated too small?",
        detail::format_short(scatter.ratio, 2), detail::quote(scatter.sample));
}

std::string describe_distance(const DistanceDoubt& distance) {
    return fmt::format(
        "socket {} is stated {} mm from {}, measured at about {} mm: is distance_mm right?",
        detail::quote(distance.socket), detail::format_short(mm_per_m * distance.stated, 4),
        detail::quote(distance.from), detail::format_short(mm_per_m * distance.found, 4));
}

/// Views of one kind together.
void describe_views(const std::vector<ViewDoubt>& views, const std::string& at,
                    std::vector<std::string>& sentences) {
    std::vector<ViewDoubt> rest = views;
    while (!rest.empty()) {
        const auto is_alike = [one = rest.front()](const ViewDoubt& other) {
            return other.is_no_board == one.is_no_board && other.order == one.order &&
                   other.camera == one.camera &&
                   std::isfinite(other.distance) == std::isfinite(one.distance);
        };
        std::vector<std::string> names;
        ViewDoubt worst = rest.front();
        for (const ViewDoubt& view : rest) {
            if (!is_alike(view)) continue;
            names.push_back(view.sample);
            worst.distance = std::max(worst.distance, view.distance);
        }
        std::erase_if(rest, is_alike);
        const std::string by = fmt::format("{} px RMS, other views by {}",
                                           detail::format_short(1e3 * worst.distance, 3),
                                           detail::format_short(1e3 * worst.others, 3));
        std::string wrong, mend = "find them anew";
        if (worst.is_no_board && !std::isfinite(worst.distance)) {
            wrong =
                "corners at one place, on one line or scattered, as no pose of the board shows "
                "them";
        } else if (worst.is_no_board && worst.order.empty()) {
            wrong = fmt::format("corners are off any pose of the board by {}", by);
        } else if (!worst.order.empty()) {
            wrong = fmt::format("corners are numbered {} (off by {}; renumbered they fit)",
                                worst.order, by);
            mend = "renumber them";
        } else {
            wrong = fmt::format("the board is not where the joint values say (off by {})", by);
            mend = "are these another view's joint values, or was the board moved? Mend them";
        }
        sentences.push_back(
            fmt::format("{}{} {}{}: {}; {} or leave {} out, {}", at,
                        names.size() == 1 ? "view" : "views", fmt::join(names, ", "),
                        worst.camera > 0 ? fmt::format(" of camera {}", worst.camera + 1) : "",
                        wrong, mend, names.size() == 1 ? "it" : "them", spell(exclusion(names))));
    }
}

/// `fits`: the robot stated does; else a lens that is found tells nothing of the image.
void describe_camera(const CameraDoubt& doubt, bool fits, const std::string& where,
                     std::vector<std::string>& sentences) {
    const std::string at =
        where + (doubt.sensor > 0 ? fmt::format("sensor {}: ", doubt.sensor) : "");
    if (doubt.board_factor != 1) {
        const std::string size =
            doubt.square > 0
                ? fmt::format("squares of {} mm fit, not of {} mm",
                              detail::format_short(mm_per_m * doubt.square * doubt.board_factor, 4),
                              detail::format_short(mm_per_m * doubt.square, 4))
                : fmt::format("a board {} times as large as stated fits",
                              detail::format_short(doubt.board_factor, 4));
        sentences.push_back(
            fmt::format("{}{} (calibrated, the robot misses the corners by {} instead of {} px "
                        "RMS): measure the "
                        "board",
                        at, size, detail::format_short(1e3 * doubt.scaled_misfit, 3),
                        detail::format_short(1e3 * doubt.misfit, 3)));
    }
    if (const auto& point = doubt.principal_point) {
        sentences.push_back(fmt::format(
            "{}the principal point{} ({:.0f}, {:.0f}) px is far from the middle of {} ({:.0f}, "
            "{:.0f}): are the intrinsics of this image, neither scaled, cropped nor turned?",
            at, doubt.camera > 0 ? fmt::format(" of camera {}", doubt.camera + 1) : "", (*point)[0],
            (*point)[1], doubt.is_of_image ? "the image" : "what is seen", doubt.middle[0],
            doubt.middle[1]));
    }
    const std::string of_camera =
        doubt.camera > 0 ? fmt::format(" of camera {}", doubt.camera + 1) : "";
    if (const auto& stated = doubt.stated_focal_lengths; stated && fits) {
        sentences.push_back(fmt::format(
            "{}the focal lengths found{} are {:.0f} and {:.0f} px, not about {:.0f} and {:.0f} px "
            "as stated: are the intrinsics and image_px of this image, not of one of another size? "
            "Poses are planned by them",
            at, of_camera, (*doubt.focal_lengths)[0], (*doubt.focal_lengths)[1], (*stated)[0],
            (*stated)[1]));
    } else if (const auto& focal = doubt.focal_lengths; focal && !stated) {
        sentences.push_back(fmt::format(
            "{}the focal lengths found{} are {:.0f} and {:.0f} px, as of a mirrored image: are the "
            "columns u and v exchanged, or the corners numbered in mirrored order?",
            at, of_camera, (*focal)[0], (*focal)[1]));
    }
    if (doubt.scatter > 0) {
        sentences.push_back(fmt::format(
            "{}corners scatter by {} px about whatever pose of the board suits a view; "
            "sensor.sigma_px says {}",
            at, detail::format_short(doubt.scatter, 2), detail::format_short(doubt.sigma, 2)));
    }
    if (doubt.is_seen_from_back) {
        sentences.push_back(
            at +
            "the board is seen from behind: corners are numbered in mirrored order, or y "
            "points upwards on it (then state sensor.view.front: +z); poses planned would "
            "show its back");
    }
}

std::string describe_no_length(const Sensor& sensor) {
    return fmt::format(
        "no length is stated: how large the robot is follows from its nominal lengths alone; state "
        "{}",
        sensor.has_contacts()
            ? "the distance of two sockets of one body, keys from and distance_mm"
            : "how far a plane is from the base, which must be known (known: [offset], of one not "
              "through the base itself), or where the target is on the flange "
              "(sensor.targets.known)");
}

std::string describe_held_out(const Campaign& campaign, const HeldOutComparison& held_out) {
    const AmountUnits& units = campaign.sensor->main_units();
    return fmt::format(
        "poses that were held out are missed by {}, by the nominal robot by {}: the calibration is "
        "not shown to be better than none",
        detail::format_error(held_out.calibrated, units),
        detail::format_error(held_out.nominal, units));
}

/// Says of poses that judge the calibration if they are missed by no less than before, and if one
/// of them has nearly all of the error.
void add_judged(const std::optional<Judgement>& judged, const char* which,
                std::vector<std::string>& sentences) {
    constexpr double plainly = 2;
    if (!judged || judged->moved) return;
    for (const JudgedGroup& group : judged->groups) {
        if (group.is_no_better() && group.group != PoseGroup::Repeated) {
            sentences.push_back(fmt::format(
                "{}: missed by {}, by the nominal robot by {}: the calibration gains nothing there",
                which, detail::format_error(group.found.rms(), *judged->units),
                detail::format_error(*group.nominal, *judged->units)));
        }
        const auto& worst = group.worst;
        if (!worst || !(group.found.rms() > plainly * worst->without)) continue;
        sentences.push_back(fmt::format(
            "{}: most of what they are missed by is of {}: {} with it, {} without; is its reading "
            "right?",
            which, detail::quote(worst->id),
            detail::format_error(group.found.rms(), *judged->units),
            detail::format_error(worst->without, *judged->units)));
    }
}

}  // namespace

std::vector<std::string> describe_doubts(const Calibration& calibration,
                                         const std::string& measurements) {
    const Doubts& doubts = calibration.doubts;
    const std::string at = measurements.empty() ? "" : measurements + ": ";
    std::vector<std::string> sentences;
    const bool has_moved = calibration.moved_since.has_value();  // much follows from it
    if (doubts.misfit && !doubts.look.shifted && !has_moved) {
        sentences.push_back(at + describe_misfit(calibration.campaign, *doubts.misfit));
    }
    if (!doubts.planes.empty()) sentences.push_back(at + describe_planes(doubts.planes));
    describe_views(doubts.views, at, sentences);
    if (doubts.camera) describe_camera(*doubts.camera, !doubts.misfit, at, sentences);
    if (!doubts.places.empty() && !has_moved)
        sentences.push_back(at + describe_places(doubts.places));
    if (doubts.gross_error && !has_moved) {
        sentences.push_back(fmt::format("{}the nominal robot misses the {} by {} m (RMS)", at,
                                        calibration.campaign.sensor->words().readings,
                                        detail::format_short(*doubts.gross_error, 3)));
    }
    if (doubts.orientations) {
        sentences.push_back(fmt::format(
            "{}the nominal robot misses the orientations by {} deg (RMS){}", at,
            detail::format_short(to_degrees(*doubts.orientations), 3),
            doubts.misfit && doubts.misfit->reading
                ? ""
                : "; in no other sense of their columns that was tried by clearly less"));
    }
    if (calibration.moved_since) {
        sentences.push_back(at + "measured with another set-up than the earlier estimate, " +
                            describe_moved(*calibration.moved_since, "that found it", "--moved"));
    }
    if (!doubts.learned_sizes.empty() && !has_moved) {
        sentences.push_back(describe_learned_sizes(doubts.learned_sizes));
    }
    if (!doubts.sizes.empty() && !has_moved) {
        sentences.push_back(describe_sizes(calibration.campaign.spread.is_prior, doubts.sizes));
    }
    if (!doubts.model_errors.empty() && !has_moved) {
        sentences.push_back(describe_model_errors(doubts.model_errors));
    }
    if (doubts.scatter) sentences.push_back(at + describe_scatter(*doubts.scatter));
    if (doubts.lacks_length) sentences.push_back(describe_no_length(*calibration.campaign.sensor));
    if (doubts.distance) sentences.push_back(at + describe_distance(*doubts.distance));
    if (doubts.small_residuals) {
        const bool is_of_model = calibration.campaign.robot.parameter_count() > 0 &&
                                 calibration.nominal.rms() < 2 * calibration.estimate.fit.rms();
        sentences.push_back(
            fmt::format("the residuals are {} times what sigma and model error say: is one of them "
                        "stated in um? Then sigma_um or model_error_um is its key{}",
                        detail::format_short(*doubts.small_residuals, 2),
                        is_of_model ? ". Nor does the nominal robot miss them by more: were they "
                                      "measured, or are they where a plan expects the targets?"
                                    : ""));
    }
    if (calibration.moved) {
        sentences.push_back(
            "the validation was measured with another set-up, " +
            describe_moved(*calibration.moved, "the calibration has it", "--refit"));
    }
    const auto add_others = [&](const std::optional<Judgement>& judged, const char* which) {
        if (!judged || !judged->moved) return;
        sentences.push_back(fmt::format(
            "{} were measured with another set-up, {} from where the calibration has it", which,
            describe_distances(*judged->moved)));
    };
    add_others(calibration.verification, "the poses to verify");
    add_others(calibration.left_out, "the poses not in the plan");
    if (!calibration.moved)
        add_judged(calibration.validation, "poses of the validation", sentences);
    add_judged(calibration.verification, "poses to verify", sentences);
    add_judged(calibration.left_out, "poses not in the plan", sentences);
    for (const std::string& sentence :
         detail::describe_look(doubts.look, calibration.cures, calibration.campaign)) {
        sentences.push_back(at + sentence);
    }
    if (doubts.held_out) {
        sentences.push_back(at + describe_held_out(calibration.campaign, *doubts.held_out));
    }
    if (const auto& workspace = doubts.workspace) {
        const AmountUnits& units = calibration.campaign.sensor->main_units();
        sentences.push_back(fmt::format(
            "{}it is expected to miss poses of the workspace by {}, the nominal robot misses those "
            "measured by {}: too few poses, or too much alike, to calibrate it by",
            at, detail::format_error(workspace->expected, units),
            detail::format_error(workspace->nominal, units)));
    }
    if (sentences.empty() && calibration.faults.empty()) return sentences;
    for (const Cure& cure : calibration.cures.found) {
        sentences.push_back(at + detail::describe(cure, calibration.campaign));
    }
    return sentences;
}

std::string describe_still_joints(const Campaign& campaign, const std::vector<Index>& joints) {
    std::string names;
    for (std::size_t k = 0; k < joints.size(); ++k) {
        if (k > 0) names += k + 1 == joints.size() ? " and " : ", ";
        names += campaign.robot.joints()[static_cast<std::size_t>(joints[k])].name;
    }
    if (joints.empty()) return "";
    return fmt::format(
        "{} {} the same in all configurations: these say little about {} errors; are all columns "
        "right?",
        names, joints.size() == 1 ? "is" : "are", joints.size() == 1 ? "its" : "their");
}

std::string describe(const BeyondLimits& beyond, const std::vector<std::string>& ids) {
    return fmt::format(
        "{} of {} configurations {} beyond the campaign's joint limits, the first is {}: {}",
        beyond.count, ids.size(), beyond.count == 1 ? "is" : "are",
        detail::quote(ids[static_cast<std::size_t>(beyond.first)]), beyond.violation);
}

}  // namespace posewise
