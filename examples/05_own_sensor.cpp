// An instrument the library does not have: a camera that measures the directions of three targets.
// The program compares the camera's Jacobian with central differences, builds a campaign with the
// camera in C++ and chooses 20 of 300 random poses by criterion V. The UR10 comes from a file.
//
// Run from the repository's root: build/examples/05_own_sensor
#include <cmath>
#include <iostream>
#include <posewise/jacobian/identification.hpp>
#include <posewise/posewise.hpp>

using namespace posewise;

/// The camera stands at the origin of the world and looks along z. Of each target it measures the
/// angles (rad) atan2(x, z) and atan2(y, z), each with standard deviation sigma.
class Camera final : public Sensor {
  public:
    Camera(Targets targets, double sigma) : targets_(std::move(targets)), sigma_(sigma) {}
    const Targets& targets() const override { return targets_; }
    Index row_count() const override { return 2 * targets_.count(); }
    bool is_angle(Index) const override { return true; }
    std::vector<std::string> observation_names() const override {
        return {"p1_right", "p1_down", "p2_right", "p2_down", "p3_right", "p3_down"};
    }
    std::vector<std::string> unknown_names() const override { return targets_.unknown_names(); }
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override {
        for (Index row = 0; row < row_count(); ++row) {
            const Vector3d p = world_from_flange * targets_.position(row / 2, unknowns);
            observation[row] = std::atan2(p[row % 2], p.z());
        }
    }
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J) const override {
        RowMatrixXd J_positions(3 * targets_.count(), J.cols());
        targets_.differentiate(world_from_flange, twists, unknowns, J_positions);
        for (Index row = 0; row < row_count(); ++row) {
            const Vector3d p = world_from_flange * targets_.position(row / 2, unknowns);
            const double x = p[row % 2], z = p.z();
            const auto J_p = J_positions.middleRows<3>(3 * (row / 2));
            J.row(row) = (z * J_p.row(row % 2) - x * J_p.row(2)) / (x * x + z * z);
        }
    }
    void covariance(const Isometry3d&, const VectorXd&, Eigen::Ref<MatrixXd> C) const override {
        C = sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
    }

  private:
    Targets targets_;
    double sigma_;
};

/// Largest relative difference of a column of the identification Jacobian from central differences.
double jacobian_error(const Campaign& campaign, const VectorXd& q) {
    const auto predict = [&](const VectorXd& step) {
        const Parameters moved = advance(campaign, campaign.nominal, step);
        return campaign.sensor->predict(world_from_flange(campaign, moved, q), moved.sensor);
    };
    FlangeMotion motion;
    RowMatrixXd J(campaign.sensor->row_count(), parameter_count(campaign));
    differentiate_pose(campaign, campaign.nominal, q, motion, J);
    double error = 0;
    for (Index k = 0; k < J.cols(); ++k) {
        const VectorXd step = 1e-4 * VectorXd::Unit(J.cols(), k);  // m or rad
        const VectorXd column = (predict(step) - predict(-step)) / 2e-4;
        error = std::fmax(error, (J.col(k) - column).norm() / column.norm());
    }
    return error;
}

int main() {
    Campaign campaign;
    campaign.name = "UR10 before a camera";
    campaign.sensor = std::make_shared<Camera>(
        Targets({Vector3d(0.06, 0, 0.05), Vector3d(-0.04, 0.05, 0.03), std::nullopt}), 20e-6);
    campaign.model_error_orientation = 30e-6;  // rad: 0.1 mm seen from 3 m
    // The base is 3 m in front of the camera. Its z axis points up, its x axis at the camera.
    campaign.nominal.world_from_base.matrix() << 0, 1, 0, 0, 0, 0, -1, 0, -1, 0, 0, 3, 0, 0, 0, 1;
    campaign.nominal.sensor = Vector3d(0, -0.06, 0.08);  // target 3 in the flange frame, m
    campaign.has_nominal_base = campaign.has_nominal_targets = true;
    campaign = with_robot(campaign, io::read_campaign("designs/ur10/campaign.yaml").robot);
    const Candidates candidates = random_candidates(campaign, 300, 1);
    std::cout << "Jacobian against central differences: relative error "
              << jacobian_error(campaign, candidates.configurations.row(0).transpose()) << '\n';
    ChoiceOptions options;
    options.criterion = Criterion::V;
    options.pose_count = 20;
    options.starts = 10;
    std::cout << format_choice(choose(campaign, candidates, options));
}
