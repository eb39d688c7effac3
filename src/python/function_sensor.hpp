#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>
#include <vector>

#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::python {

/// What a Python function of an instrument is stated with.
struct FunctionSensorParts {
    pybind11::function predict;        ///< (frame 4 x 4, unknowns) to row_count() numbers
    std::vector<std::string> names;    ///< of the numbers, without units
    std::vector<bool> is_angle;        ///< of each
    VectorXd sigmas;                   ///< their standard deviations, m or rad
    Targets targets;                   ///< on the flange
    std::vector<std::string> unknown;  ///< names of what else is unknown, without units
    std::vector<bool> unknown_is_angle;
};

/// An instrument that a Python function describes; derivatives are differences of it. Each call
/// waits for the interpreter's lock, so threads do not help.
class FunctionSensor final : public Sensor {
  public:
    /// Throws InputError for lists of other lengths, or deviations that are none.
    explicit FunctionSensor(FunctionSensorParts parts);

    const Targets& targets() const override { return parts_->targets; }
    Index row_count() const override { return static_cast<Index>(parts_->names.size()); }
    std::vector<std::string> observation_names() const override { return parts_->names; }
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    bool is_angle(Index row) const override {
        return parts_->is_angle[static_cast<std::size_t>(row)];
    }
    /// Throws InputError if the function returns other than as many finite numbers.
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    /// Central differences of 0.1 mm and 0.1 mrad, extrapolated [Richardson 1911].
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void covariance(const Isometry3d&, const VectorXd&,
                    Eigen::Ref<MatrixXd> covariance) const override {
        covariance = parts_->sigmas.cwiseAbs2().asDiagonal();
    }
    bool has_constant_covariance() const override { return true; }

  private:
    /// Python's part is given back with the interpreter's lock, wherever the last owner ends.
    std::shared_ptr<const FunctionSensorParts> parts_;
};

/// The campaign with that instrument in place of its own, and these values of its unknowns; errors
/// that are reduced to what can be identified are reduced anew.
io::CampaignFile with_sensor(const io::CampaignFile& campaign,
                             std::shared_ptr<const FunctionSensor> sensor,
                             const VectorXd& unknowns);

/// Whether that is its instrument: its file states another.
bool has_function_sensor(const Campaign& campaign);

}  // namespace posewise::python
