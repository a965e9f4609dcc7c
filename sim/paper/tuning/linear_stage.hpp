// A stage linearised about a depth, in discrete time: x[k+1] = A x[k] + B u[k], y[k] = C x[k], u the
// amplitude of the square wave in V, y the reading in mm. The 1 ms hold, the oil, the spring and the sensor's
// lag are included.
#pragma once

#include <Eigen/Core>
#include <complex>

#include "sim/paper/tuning/margins.hpp"
#include "sim/plant/plant_model.hpp"

namespace biopsy::sim::tuning {

struct LinearStage {
  Eigen::MatrixXd A;
  Eigen::VectorXd B;
  Eigen::RowVectorXd C;
};

// The stage without effects that are slow or not differentiable (those without `linearises`), without tissue,
// and without leakage, whose contribution changes sign at every reversal of the square wave. Their influence
// is evaluated in time, by score().
PlantModel smooth(PlantModel model);

// Whether 8 kV hold the smooth stage at that depth (mm).
bool can_hold(const PlantModel& model, double depth);

// Around `depth` (mm), which must be above 0 and held by 8 kV: throws ConfigError.
LinearStage linearised(const PlantModel& model, double depth);

// y per u at that angular frequency (rad/s). mm/V
std::complex<double> response(const LinearStage& stage, double omega);

// At each of frequencies().
std::vector<std::complex<double>> response(const LinearStage& stage);

// All poles of the loop within the unit circle.
bool holds(const LinearStage& stage, const PiGains& gains);

}  // namespace biopsy::sim::tuning
