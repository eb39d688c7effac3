#include "function_sensor.hpp"

#include <fmt/format.h>
#include <pybind11/eigen.h>

#include <utility>

#include "call.hpp"
#include "measurement/differences.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::python {
namespace {

namespace py = pybind11;

void check_parts(const FunctionSensorParts& parts) {
    const auto rows = static_cast<Index>(parts.names.size());
    const Index targets = parts.targets.count();
    if (rows == 0 || targets == 0 || rows % targets != 0) {
        throw InputError(
            fmt::format("`sensor` has {} numbers for {} targets; must have equally "
                        "many for each",
                        rows, targets));
    }
    if (parts.sigmas.size() != rows || !parts.sigmas.allFinite() ||
        !(parts.sigmas.array() > 0).all()) {
        throw InputError(fmt::format(
            "`sensor` must have {} standard deviations above 0, one for each number", rows));
    }
}

constexpr double difference_step = 1e-4;  // m or rad

}  // namespace

FunctionSensor::FunctionSensor(FunctionSensorParts parts) {
    check_parts(parts);
    parts_ = std::shared_ptr<const FunctionSensorParts>(new FunctionSensorParts(std::move(parts)),
                                                        [](const FunctionSensorParts* last) {
                                                            const py::gil_scoped_acquire lock;
                                                            delete last;
                                                        });
}

std::vector<std::string> FunctionSensor::unknown_names() const {
    std::vector<std::string> names = parts_->targets.unknown_names();
    names.insert(names.end(), parts_->unknown.begin(), parts_->unknown.end());
    return names;
}

std::vector<bool> FunctionSensor::unknown_is_angle() const {
    std::vector<bool> are(static_cast<std::size_t>(parts_->targets.unknown_count()), false);
    are.insert(are.end(), parts_->unknown_is_angle.begin(), parts_->unknown_is_angle.end());
    return are;
}

void FunctionSensor::predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                             Eigen::Ref<VectorXd> observation) const {
    const py::gil_scoped_acquire lock;
    const UnforkedProcess here;
    const RowMatrixXd frame = world_from_flange.matrix();
    VectorXd numbers;
    try {
        numbers = parts_->predict(frame, unknowns).cast<VectorXd>();
    } catch (const py::cast_error&) {
        throw InputError("`sensor.predict` returned no array of numbers");
    }
    if (numbers.size() != row_count() || !numbers.allFinite()) {
        throw InputError(fmt::format(
            "`sensor.predict` returned {} numbers{}; must return {}, finite", numbers.size(),
            numbers.allFinite() ? "" : ", not all finite", row_count()));
    }
    observation = numbers;
}

void FunctionSensor::differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                   const VectorXd& unknowns,
                                   Eigen::Ref<RowMatrixXd> J_measured_parameters) const {
    MatrixXd J_twist(row_count(), 6);
    for (Index axis = 0; axis < 6; ++axis) {
        J_twist.col(axis) = detail::slope_at_zero(difference_step, [&](double step) {
            const Twist twist = step * Twist::Unit(axis);
            return Sensor::predict(detail::moved(world_from_flange, twist), unknowns);
        });
    }
    J_measured_parameters.leftCols(twists.cols()) = J_twist.lazyProduct(twists);
    for (Index k = 0; twists.cols() + k < J_measured_parameters.cols(); ++k) {
        J_measured_parameters.col(twists.cols() + k) =
            detail::slope_at_zero(difference_step, [&](double step) {
                return Sensor::predict(world_from_flange,
                                       unknowns + step * VectorXd::Unit(unknowns.size(), k));
            });
    }
}

io::CampaignFile with_sensor(const io::CampaignFile& campaign,
                             std::shared_ptr<const FunctionSensor> sensor,
                             const VectorXd& unknowns) {
    io::CampaignFile file = campaign;
    const auto count = static_cast<Index>(sensor->unknown_names().size());
    if (unknowns.size() != count) {
        throw InputError(
            fmt::format("`sensor` has {} unknowns, {} values are stated", count, unknowns.size()));
    }
    const bool is_reduced =
        file.error_model == io::ErrorModel::Complete || file.error_model == io::ErrorModel::Offsets;
    file.sensor = std::move(sensor);
    file.nominal.sensor = unknowns;
    file.has_nominal_targets = true;
    file.planned_model.reset();
    if (is_reduced) {
        static_cast<Campaign&>(file) = with_robot(file, file.declared_robot);
        static_cast<Campaign&>(file) =
            with_robot(file, file.error_model == io::ErrorModel::Offsets ? irreducible_offsets(file)
                                                                         : irreducible_model(file));
    }
    return file;
}

bool has_function_sensor(const Campaign& campaign) {
    return dynamic_cast<const FunctionSensor*>(campaign.sensor.get()) != nullptr;
}

}  // namespace posewise::python
