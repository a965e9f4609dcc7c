#include "sim/paper/tuning/linear_stage.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "robot/common/config_error.hpp"
#include "sim/paper/feed_forward.hpp"
#include "sim/plant/plant.hpp"

namespace biopsy::sim::tuning {
namespace {

constexpr double kHighest = 8000.0;  // V
constexpr double kNoLeak = 1e12;     // s

// One coordinate of the plant's state, and the step for its derivative.
struct Coordinate {
  double& (*of)(PlantState&);
  double small;
};

std::vector<Coordinate> coordinates(const PlantModel& model) {
  std::vector<Coordinate> all{{[](PlantState& s) -> double& { return s.motion.H; }, 1e-8},
                              {[](PlantState& s) -> double& { return s.motion.x; }, 1e-7},
                              {[](PlantState& s) -> double& { return s.motion.v; }, 1e-6}};
  if (const auto& lag = model.effects.sensor_lag) {
    all.push_back({[](PlantState& s) -> double& { return state_of<SensorLag>(s).lagged; }, 1e-7});
    if (lag->delay > 0.0) {
      all.push_back({[](PlantState& s) -> double& { return state_of<SensorLag>(s).w; }, 1e-7});
      all.push_back({[](PlantState& s) -> double& { return state_of<SensorLag>(s).Dw; }, 1e-7});
    }
  }
  if (model.effects.amplifier_lag && !model.effects.amplifier_lag->amplifier().instant())
    all.push_back({[](PlantState& s) -> double& { return s.u_i; }, 1e-2});
  return all;
}

Eigen::VectorXd values(const std::vector<Coordinate>& all, PlantState state) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) out[static_cast<Eigen::Index>(i)] = all[i].of(state);
  return out;
}

// One tick later. Without leakage u_o = K u_i.
PlantState later(const PlantModel& model, PlantState state, double amplitude) {
  state.u_o = model.baseline.K * state.u_i;
  return step(model, state, {.voltage = amplitude}, Seconds(kTick_s));
}

PlantState at_depth(const PlantModel& model, double depth, double amplitude) {
  PlantState state = at_rest(model);
  state.u_i = amplitude;
  state.u_o = model.baseline.K * amplitude;
  state.u_command = amplitude;
  set_state(model, state, depth * 1e-3, 0.0);
  return state;
}

}  // namespace

PlantModel smooth(PlantModel model) {
  for_each_effect(model.effects, []<class E>(std::optional<E>& effect) {
    if constexpr (!requires { E::linearises; }) effect.reset();
  });
  std::erase_if(model.terms,
                [](const Term& term) { return term.has_dry_friction() || term.memory_time > 0.0; });
  model.tissue.clear();
  model.baseline.tau = kNoLeak;
  return model;
}

bool can_hold(const PlantModel& model, double depth) {
  return depth > 0.0 && paper::holding_voltage(smooth(model), depth, 0, kHighest) < kHighest;
}

LinearStage linearised(const PlantModel& full, double depth) {
  const PlantModel model = smooth(full);
  if (!can_hold(full, depth))
    throw ConfigError(fmt::format("a depth of {} mm cannot be held with {:.0f} kV", depth, kHighest * 1e-3),
                      "the stage's model", "use a model with more stroke, or less weight");
  const double amplitude = paper::holding_voltage(model, depth, 0, kHighest);
  const PlantState middle = at_depth(model, depth, amplitude);
  const std::vector<Coordinate> all = coordinates(model);
  const auto size = static_cast<Eigen::Index>(all.size());
  LinearStage out{Eigen::MatrixXd(size, size), Eigen::VectorXd(size), Eigen::RowVectorXd(size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    const Coordinate& c = all[static_cast<std::size_t>(i)];
    PlantState up = middle, down = middle;
    c.of(up) += c.small;
    c.of(down) -= c.small;
    out.A.col(i) = (values(all, later(model, up, amplitude)) - values(all, later(model, down, amplitude))) /
                   (2.0 * c.small);
    out.C[i] = (displacement_reading(model, up) - displacement_reading(model, down)) / (2.0 * c.small) * 1e3;
  }
  constexpr double volts = 0.1;
  out.B = (values(all, later(model, middle, amplitude + volts)) -
           values(all, later(model, middle, amplitude - volts))) /
          (2.0 * volts);
  return out;
}

std::complex<double> response(const LinearStage& stage, double omega) {
  const std::complex<double> z = std::polar(1.0, omega * kTick_s);
  const Eigen::Index size = stage.A.rows();
  const Eigen::MatrixXcd inverse = z * Eigen::MatrixXcd::Identity(size, size) - stage.A;
  const Eigen::VectorXcd x = inverse.partialPivLu().solve(stage.B.cast<std::complex<double>>());
  return (stage.C.cast<std::complex<double>>() * x)(0);
}

std::vector<std::complex<double>> response(const LinearStage& stage) {
  std::vector<std::complex<double>> out;
  out.reserve(frequencies().size());
  for (const double omega : frequencies()) out.push_back(response(stage, omega));
  return out;
}

// States of the stage and the loop's sum: u = sum + (K_p + K_i) e, sum' = sum + K_i e, e = -C x.
bool holds(const LinearStage& stage, const PiGains& gains) {
  const Eigen::Index size = stage.A.rows();
  const double at_once = gains.proportional_V_per_mm + gains.integral_V_per_mm_per_tick;
  Eigen::MatrixXd closed(size + 1, size + 1);
  closed.topLeftCorner(size, size) = stage.A - at_once * stage.B * stage.C;
  closed.topRightCorner(size, 1) = stage.B;
  closed.bottomLeftCorner(1, size) = -gains.integral_V_per_mm_per_tick * stage.C;
  closed(size, size) = 1.0;
  return closed.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
}

}  // namespace biopsy::sim::tuning
