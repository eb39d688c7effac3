#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "call.hpp"
#include "function_sensor.hpp"
#include "inputs.hpp"
#include "keywords.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/inspection.hpp"
#include "posewise/task/planning.hpp"

/// The compiled half of the Python package: calls of the library that take and return what needs no
/// Python class, arrays and documents. The other half is python/posewise.
namespace posewise::python {
namespace {

namespace py = pybind11;

/// A document, the same as text, and warnings.
using Result = std::tuple<std::string, std::string, Sentences>;

/// An array that owns the numbers of a matrix.
py::array_t<double> to_array(RowMatrixXd&& matrix, std::vector<py::ssize_t> shape) {
    auto* const kept = new RowMatrixXd(std::move(matrix));
    const py::capsule owner(kept, [](void* numbers) { delete static_cast<RowMatrixXd*>(numbers); });
    return py::array_t<double>(std::move(shape), kept->data(), owner);
}

// ---- Campaigns ----

io::CampaignFile parse_campaign(const std::string& content, const std::string& path) {
    return call([&](const CallControl& control) {
        return io::parse_campaign(content, path, control.stop);
    });
}

/// Blocks of all targets, as many rows for each pose: poses x rows x parameters.
py::array_t<double> jacobian(const io::CampaignFile& campaign, const RowMatrixXd& q, bool is_scaled,
                             double repeats, const CallOptions& options) {
    const auto compute = [&] {
        return is_scaled ? make_blocks(campaign, campaign.nominal, q, repeats)
                         : make_plain_blocks(campaign, campaign.nominal, q);
    };
    constexpr Index few = 100;
    Blocks blocks = q.rows() < few ? call_here(compute)
                                   : call(options, [&](const CallControl&) { return compute(); });
    const Index poses = blocks.count();
    const Index rows = poses > 0 ? blocks.matrix.rows() / poses : campaign.sensor->row_count();
    const Index columns = blocks.parameter_count();
    return to_array(std::move(blocks.matrix), {poses, rows, columns});
}

/// world_from_flange of the nominal robot, poses x 4 x 4, m.
py::array_t<double> flange(const io::CampaignFile& campaign, const RowMatrixXd& q) {
    RowMatrixXd frames(4 * q.rows(), 4);
    for (Index i = 0; i < q.rows(); ++i) {
        frames.middleRows(4 * i, 4) =
            world_from_flange(campaign, campaign.nominal, q.row(i).transpose()).matrix();
    }
    return to_array(std::move(frames), {q.rows(), 4, 4});
}

/// What the board that a camera sees shows, by the names of BoardPattern and CameraSetup; None of
/// other sensors.
py::object board(const io::CampaignFile& campaign) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get());
    if (camera == nullptr) return py::none();
    constexpr std::array kinds{"points", "chessboard", "charuco", "aprilgrid"};
    const CameraSetup& setup = camera->setup();
    const BoardPattern& pattern = setup.pattern;
    RowMatrixXd corners(std::ssize(setup.corners), 3);
    for (Index k = 0; const Vector3d& corner : setup.corners) corners.row(k++) = corner;
    return py::dict(py::arg("kind") = kinds[static_cast<std::size_t>(pattern.kind)],
                    py::arg("columns") = pattern.columns, py::arg("rows") = pattern.rows,
                    py::arg("marker") = pattern.marker, py::arg("dictionary") = pattern.dictionary,
                    py::arg("is_legacy") = pattern.is_legacy, py::arg("corners") = corners,
                    py::arg("first_point") = setup.first_corner,
                    py::arg("cameras") = camera->camera_count());
}

Inspection inspect_campaign(const io::CampaignFile& campaign) {
    return inspect(campaign, campaign.declared_robot,
                   campaign.error_model == io::ErrorModel::Stated);
}

void define_campaign(py::module_& module) {
    py::class_<io::CampaignFile>(module, "Campaign")
        .def(py::init(&parse_campaign), py::arg("content"), py::arg("path"))
        .def_readonly("name", &io::CampaignFile::name)
        .def_readonly("path", &io::CampaignFile::path)
        .def_readonly("content", &io::CampaignFile::content)
        .def_readonly("warnings", &io::CampaignFile::warnings)
        .def_property_readonly(
            "columns", [](const io::CampaignFile& file) { return configuration_columns(file); })
        .def_property_readonly("parameter_names",
                               [](const io::CampaignFile& file) { return parameter_names(file); })
        .def_property_readonly(
            "parameter_is_angle",
            [](const io::CampaignFile& file) { return parameter_is_angle(file); })
        .def_property_readonly("board", &board)
        .def_property_readonly("parameter_sizes",
                               [](const io::CampaignFile& file) { return parameter_scale(file); })
        .def("with_sensor",
             [](const io::CampaignFile& file, py::function predict, std::vector<std::string> names,
                std::vector<bool> is_angle, VectorXd sigmas,
                const std::vector<std::optional<Vector3d>>& targets,
                std::vector<std::string> unknown, std::vector<bool> unknown_is_angle,
                const VectorXd& values) {
                 const auto sensor = std::make_shared<const FunctionSensor>(FunctionSensorParts{
                     std::move(predict), std::move(names), std::move(is_angle), std::move(sigmas),
                     Targets(targets), std::move(unknown), std::move(unknown_is_angle)});
                 return call([&](const CallControl&) { return with_sensor(file, sensor, values); });
             })
        .def("jacobian", &jacobian)
        .def("flange", &flange)
        .def("inspect", [](const io::CampaignFile& file, const CallOptions& options) -> Result {
            return call(options, [&](const CallControl&) -> Result {
                const Inspection found = inspect_campaign(file);
                return {io::to_json(found), format(found), {}};
            });
        });
}

// ---- Choices ----

Result to_result(const Plan& plan, Sentences warnings) {
    warnings.insert(warnings.end(), plan.cell_doubts.begin(), plan.cell_doubts.end());
    return {io::with_sentences(io::to_json(plan, ""), warnings, answer(plan)), format_choice(plan),
            warnings};
}

Result to_result(const Verification& verification, const Plan& plan) {
    return {io::to_json(verification, plan, ""), format_findings(verification.findings), {}};
}

Result to_result(const ApproximateDesign& design, const Sentences& warnings) {
    return {io::with_sentences(io::to_json(design), warnings), format(design), warnings};
}

// Of plain blocks or of a campaign's configurations, by overload.
constexpr auto choosing = [](auto&&... inputs) {
    return choose(std::forward<decltype(inputs)>(inputs)...);
};
constexpr auto relaxing = [](auto&&... inputs) {
    return relax_choice(std::forward<decltype(inputs)>(inputs)...);
};

/// What `compute(candidates, options)` makes of plain blocks.
template <typename Compute>
Result of_plain(const PlainBlocks& blocks, const Keywords& keywords,
                const CallOptions& call_options, const Compute& compute) {
    const PlanCall asked = choice_call(keywords);
    return call(call_options, [&](const CallControl& control) {
        ChoiceOptions options = read_plain(blocks, asked.request, asked.groups);
        control.steer(options);
        return to_result(compute(make_equal_blocks(blocks.candidates, blocks.rows), options), {});
    });
}

Result choose_plain(const PlainBlocks& blocks, const std::string& keywords,
                    const CallOptions& options) {
    return of_plain(blocks, parse_keywords("select", keywords), options, choosing);
}

Result relax_plain(const PlainBlocks& blocks, const std::string& keywords,
                   const CallOptions& options) {
    return of_plain(blocks, parse_keywords("relax", keywords), options, relaxing);
}

/// What `compute(campaign, candidates, options)` makes of configurations.
template <typename Compute>
Result of_campaign(const io::CampaignFile& campaign, const Keywords& keywords,
                   const CallOptions& call_options, const Compute& compute) {
    PlanCall asked = choice_call(keywords);
    asked.request.sources.campaign = campaign.path;
    return call(call_options, [&](const CallControl& control) {
        Sentences warnings;
        const io::CampaignFile file = planned_campaign(campaign, asked, control.stop, warnings);
        ChoiceInputs inputs = read_choice(asked, file, warnings);
        inputs.options.judge = judge(asked.is_forced, warnings);
        control.steer(inputs.options);
        const auto result = compute(file, std::move(inputs.candidates), inputs.options);
        return to_result(result, warnings);
    });
}

Result choose_of_campaign(const io::CampaignFile& campaign, const std::string& keywords,
                          const CallOptions& options) {
    return of_campaign(campaign, parse_keywords("select", keywords), options, choosing);
}

Result relax_of_campaign(const io::CampaignFile& campaign, const std::string& keywords,
                         const CallOptions& options) {
    return of_campaign(campaign, parse_keywords("relax", keywords), options, relaxing);
}

/// A plan as it was asked for. An estimate that was taken by force may be taken again.
PlanCall asked_again(const Plan& plan, std::vector<Index> groups) {
    return {plan.request, plan.request.has_prior, true,
            plan.kind,    plan.candidate_count,   std::move(groups)};
}

Result verify_plain(const std::string& document, const PlainBlocks& blocks,
                    std::vector<Index> groups) {
    const Plan plan = io::parse_plan(document, "plan");
    return call([&](const CallControl& control) {
        ChoiceOptions options = read_plain(blocks, plan.request, groups);
        options.stop = control.stop;
        return to_result(verify(plan, make_equal_blocks(blocks.candidates, blocks.rows), options),
                         plan);
    });
}

Result verify_of_campaign(const std::string& document, const io::CampaignFile& campaign,
                          std::vector<Index> groups) {
    const Plan plan = io::parse_plan(document, "plan");
    return call([&](const CallControl& control) {
        Sentences warnings;
        const PlanCall asked = asked_again(plan, groups);
        const io::CampaignFile file = planned_campaign(campaign, asked, control.stop, warnings);
        if (plan.is_continuous()) {
            PlanningOptions options = read_planning(plan.request, file, warnings);
            options.stop = control.stop;
            return to_result(verify(plan, file, options), plan);
        }
        ChoiceInputs inputs = read_choice(asked, file, warnings);
        inputs.options.stop = control.stop;
        return to_result(verify(plan, file, inputs.candidates, inputs.options), plan);
    });
}

/// Values of all criteria, by name.
std::vector<std::pair<std::string, double>> rate_blocks(const RowMatrixXd& stacked, Index poses,
                                                        const PlainBlocks& blocks) {
    const auto compute = [&](const CallControl& control) {
        const Blocks tests = make_equal_blocks(
            blocks.test_poses.rows() > 0 ? blocks.test_poses : blocks.candidates, blocks.rows);
        check_values(stacked);
        std::vector<std::pair<std::string, double>> values;
        for (const Criterion criterion : all_criteria) {
            control.stop.check("rating poses");
            values.emplace_back(criterion_name(criterion),
                                evaluate_rows(criterion, stacked, poses, &tests));
        }
        return values;
    };
    constexpr Index few = 10000;
    return blocks.candidates.size() < few ? call_here([&] { return compute({}); }) : call(compute);
}

// ---- Plans ----

Result plan_campaign(const io::CampaignFile& campaign, const std::string& keywords,
                     const CallOptions& call_options) {
    const Keywords stated = parse_keywords("plan", keywords);
    PlanCall asked = planning_call(stated);
    const std::optional<TargetOptions> target = target_options(stated);
    asked.request.sources.campaign = campaign.path;
    asked.request.time_limit = call_options.time;
    return call(call_options, [&](const CallControl& control) -> Result {
        Sentences warnings;
        const io::CampaignFile file = planned_campaign(campaign, asked, control.stop, warnings);
        for (const OnAxis& one : find_on_axis(file)) warnings.push_back(describe(one));
        PlanningOptions options = read_planning(asked.request, file, warnings);
        const std::string& repaired = asked.request.sources.repaired;
        if (!repaired.empty()) options.repaired = io::read_plan(repaired);
        options.richer = [&] { return io::richer_campaigns(file, asked.prior); };
        control.steer(options);
        if (target) {
            const TargetPlanning found = plan_for_target(file, options, *target);
            if (!found.planning) throw InputError(describe_shortfall(found));
            return {io::with_sentences(io::to_json(found, ""), warnings, answer(found)),
                    format(found) + format_planning(*found.planning), warnings};
        }
        const Planning made = make_plan(file, options);
        const auto counts = predict_other_counts(made, control.stop);
        if (made.plan.is_stopped_early()) {
            warnings.emplace_back("stopped early; the plan is the best so far");
        }
        return {io::with_sentences(io::to_json(made, counts, ""), warnings, answer(made, counts)),
                format_planning(made) + format_budget(made), warnings};
    });
}

/// Throws InputError unless the file holds a plan of that campaign.
void check_plan(const std::string& path, const io::CampaignFile& campaign) {
    const std::string mismatch = describe_mismatch(io::read_plan(path), campaign);
    if (!mismatch.empty()) throw InputError(path + ": " + mismatch);
}

/// A document of a plan as a plan file, and what goes with it.
void write_plan(const std::string& document, const std::string& path,
                const io::CampaignFile* campaign, const io::PlanTables& tables,
                const Sentences& warnings) {
    const Plan plan = io::parse_plan(document, "plan");
    if (campaign == nullptr) return io::write_plan(path, plan, warnings);
    io::write_plan(path, plan, tables, *campaign, warnings);
}

// ---- Calibrations ----

/// Calibrates with the plan's poses, as far as they were measured, and judges at the others.
void use_plan(const Plan& plan, const Campaign& campaign, const Measurements& measured,
              CalibrationOptions& options, Sentences& warnings) {
    Sentences left_out = options.excluded;
    for (const PlannedPose& pose : plan.poses) {
        if (std::ranges::find(measured.ids, pose.id) != measured.ids.end()) continue;
        if (std::ranges::find(left_out, pose.id) != left_out.end()) continue;
        warnings.push_back("pose " + pose.id + " of the plan is not among the measured ones");
        left_out.push_back(pose.id);
    }
    options.used = find_planned(plan, campaign, measured, left_out);
    options.verification = find_verification(plan, campaign, measured, options.excluded);
}

Result calibrate_campaign(const io::CampaignFile& campaign, const std::string& keywords,
                          const CallOptions& call_options) {
    CalibrationCall asked = calibration_call(parse_keywords("calibrate", keywords));
    return call(call_options, [&](const CallControl& control) -> Result {
        Sentences warnings;
        CalibrationOptions& options = asked.options;
        io::CampaignFile file = campaign;
        io::set_prior(file, asked.prior, control.stop);
        if (asked.learns_sizes) file.spread.is_open = *asked.learns_sizes;
        if (!asked.free.empty()) {
            static_cast<Campaign&>(file) = with_free_errors(file, asked.free);
        }
        std::optional<Plan> plan;
        const auto measured = read_planned(asked, file, plan, warnings);
        if (!asked.estimate.empty()) {
            options.earlier =
                read_earlier(asked.estimate, file, asked.earlier, asked.is_forced, warnings);
        }
        if (plan) use_plan(*plan, file, measured, options, warnings);
        std::optional<io::MeasurementsFile> judged;
        if (!asked.validation.empty()) {
            judged = read_measured(asked.validation, file, {}, warnings);
            options.validation = &*judged;
        }
        options.conditions = measured.conditions;
        options.global.seed = file.seed;
        if (!has_function_sensor(file)) {
            options.richer = [&] { return io::richer_campaigns(file, asked.prior); };
        }
        control.steer(options);
        const Calibration result = calibrate(file, measured, options);
        if (!result.is_identified()) throw InputError(result.estimate.undetermined);
        judge(asked.is_forced, warnings)(result);
        if (control.stop.is_set()) {
            warnings.emplace_back(
                "stopped early; what it had no time for is not there: errors held out, doubts, "
                "what would cure them");
        }
        io::Provenance made_from{"", io::checksum_of(measured), file.path, file.checksum};
        made_from.warnings = warnings;
        made_from.answers = answer(result);
        return {io::to_json(result, made_from), format(result), warnings};
    });
}

/// Throws InputError unless the file holds an estimate of that campaign's robot and sensor.
void check_estimate(const std::string& path, const io::CampaignFile& campaign) {
    io::read_estimate(path, campaign);
}

/// Expected errors at configurations: for each quantity, whether it is an angle, and a row for each
/// configuration of parameters, left over, noise, total and 95 %, then one over all; m or rad.
std::vector<std::pair<bool, RowMatrixXd>> predict(const io::CampaignFile& campaign,
                                                  const std::string& estimate_path,
                                                  const RowMatrixXd& q) {
    const io::EarlierFile earlier = io::read_earlier(estimate_path, campaign, {});
    Campaign calibrated = with_model_error(campaign, earlier.estimate);
    if (earlier.estimate.spread) calibrated.spread = *earlier.estimate.spread;
    std::vector<std::pair<bool, RowMatrixXd>> tables;
    const auto predictions = call([&](const CallControl& control) {
        return predict_errors(calibrated, earlier.estimate, q, control.stop);
    });
    for (const ErrorPrediction& prediction : predictions) {
        RowMatrixXd table(q.rows() + 1, 5);
        const auto state = [&](Index row, const PredictedError& error) {
            table.row(row) << error.parameters, error.model, error.noise, error.total(),
                error.percentile95;
        };
        for (Index i = 0; i < q.rows(); ++i) {
            state(i, prediction.each[static_cast<std::size_t>(i)]);
        }
        state(q.rows(), prediction.overall);
        tables.emplace_back(prediction.is_angle, std::move(table));
    }
    return tables;
}

// ---- Studies ----

Result to_result(const Study& study, Sentences warnings) {
    if (study.ending == Ending::NotIdentifiable) throw InputError(study.undetermined);
    const std::string early = describe_early_end(study);
    if (!early.empty()) warnings.push_back(early);
    const std::string few = describe_few_judged(study);
    if (!few.empty()) warnings.push_back(few);
    const std::vector studies{study};
    return {io::with_sentences(io::to_json(studies), warnings, answer(studies)), format(study),
            warnings};
}

Result study_campaign(const io::CampaignFile& campaign, const std::string& keywords,
                      const CallOptions& call_options) {
    StudyCall asked = study_call(parse_keywords("study", keywords));
    return call(call_options, [&](const CallControl& control) {
        Sentences warnings;
        io::CampaignFile file = campaign;
        io::set_prior(file, asked.prior, control.stop);
        control.steer(asked.options);
        if (asked.measurements.empty()) {
            return to_result(simulate_study({{"", file, std::nullopt}}, asked.options).front(), {});
        }
        asked.options.judge = judge(asked.is_forced, warnings);
        const auto measured = read_measured(asked.measurements, file, asked.excluded, warnings);
        const Study found = study(file, measured, asked.options);
        return to_result(found, warnings);
    });
}

Result study_plain(const PlainBlocks& blocks, const std::string& keywords,
                   std::vector<std::pair<std::string, std::vector<Index>>> subsets,
                   const CallOptions& call_options) {
    BlocksStudyOptions options = blocks_study_options(parse_keywords("study", keywords));
    return call(call_options, [&](const CallControl& control) -> Result {
        static_cast<ChoiceOptions&>(options) = read_plain(blocks, options, {});
        for (auto& [name, poses] : subsets) options.subsets.push_back({name, poses});
        control.steer(options);
        const BlocksStudy found = study(make_equal_blocks(blocks.candidates, blocks.rows), options);
        Sentences warnings{describe_early_end(found)};
        if (warnings.front().empty()) warnings.clear();
        return {io::to_json(found), format(found), warnings};
    });
}

void define_records(py::module_& module) {
    py::class_<CallOptions>(module, "CallOptions")
        .def(py::init([](std::optional<Index> threads, double time, py::object progress) {
                 return CallOptions{threads, time, std::move(progress)};
             }),
             py::arg("threads"), py::arg("time"), py::arg("progress"))
        .def_readonly("is_interrupted", &CallOptions::is_interrupted);
    py::class_<PlainBlocks>(module, "PlainBlocks")
        .def(py::init([](RowMatrixXd candidates, Index rows, RowMatrixXd held, Index held_count,
                         RowMatrixXd prior, RowMatrixXd test_poses) {
                 return PlainBlocks{std::move(candidates), rows,
                                    std::move(held),       held_count,
                                    std::move(prior),      std::move(test_poses)};
             }),
             py::arg("candidates"), py::arg("rows"), py::arg("held"), py::arg("held_count"),
             py::arg("prior"), py::arg("test_poses"));
}

}  // namespace
}  // namespace posewise::python

PYBIND11_MODULE(_posewise, module) {
    using namespace posewise::python;
    posewise::fix_cache_sizes();
    RunningCall::register_exit();
    module.doc() = "Compiled half of posewise; use the package posewise.";
    module.attr("version") = posewise::version;
    pybind11::register_exception<posewise::InputError>(module, "InputError", PyExc_ValueError);
    define_records(module);
    define_campaign(module);
    module.def("choose_plain", &choose_plain);
    module.def("relax_plain", &relax_plain);
    module.def("verify_plain", &verify_plain);
    module.def("choose", &choose_of_campaign);
    module.def("relax", &relax_of_campaign);
    module.def("verify", &verify_of_campaign);
    module.def("rate_blocks", &rate_blocks);
    module.def("plan", &plan_campaign);
    module.def("check_plan", &check_plan);
    module.def("write_plan", [](const std::string& document, const std::string& path,
                                const posewise::io::CampaignFile* campaign, std::string csv,
                                std::string targets, const Sentences& warnings) {
        call_here([&] {
            write_plan(document, path, campaign, {std::move(csv), std::move(targets)}, warnings);
        });
    });
    module.def("calibrate", &calibrate_campaign);
    module.def("check_estimate", &check_estimate);
    module.def("predict", &predict);
    module.def("study", &study_campaign);
    module.def("study_plain", &study_plain);
}
