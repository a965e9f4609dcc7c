#include "sim/paper/feed_forward.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "sim/paper/figures/loop_scores.hpp"

namespace biopsy::sim::paper {
namespace {

constexpr double kTick_s = 1e-3;

// A table with one value per tick as a function of time; constant after its end.
OfTime tabled(std::vector<double> values) {
  return [values = std::move(values)](double time) {
    const auto tick = static_cast<std::size_t>(std::max(0.0, std::round(time / kTick_s)));
    return values[std::min(tick, values.size() - 1)];
  };
}

std::size_t ticks_of(double seconds) {
  return static_cast<std::size_t>(std::max(1.0, std::round(seconds / kTick_s)));
}

}  // namespace

double holding_voltage(const PlantModel& stage, double depth, int coming, double highest) {
  const Baseline& b = stage.baseline;
  if (depth <= 0.0) return 0.0;
  double H = b.H_0 + depth * 1e-3 / b.n;
  if (const auto& play = stage.effects.zipping_hysteresis)
    H += 0.5 * coming * (1.0 - play->free) * play->width;
  if (H <= b.H_0) return 0.0;
  const double S = b.V0 / (b.L0 * H) - 0.25 * std::numbers::pi * H;  // eq. (18)
  if (S <= 0.0) return highest;
  const double load = (stage.mass_A() + b.m_B) * b.g;
  const double P = load / (b.L0 * S);                                               // eq. (19)
  double u_o = b.d_film * std::sqrt(2.0 * P / (b.eps_film * kVacuumPermittivity));  // eq. (21)
  if (const auto& power = stage.effects.voltage_power) u_o = power->voltage_for(u_o);
  return std::min(u_o / b.K, highest);
}

OfTime feed_forward(const PlantModel& stage, const OfTime& target, double seconds) {
  std::vector<double> volts(ticks_of(seconds));
  double depth = target(0.0);
  int coming = depth > 0.0 ? 1 : 0;
  for (std::size_t k = 0; k < volts.size(); ++k) {
    const double next = target(static_cast<double>(k + 1) * kTick_s);
    if (next != depth) coming = next > depth ? 1 : -1;
    const double step = std::abs(next - depth) < kJump ? next - depth : 0.0;
    volts[k] = holding_voltage(stage, depth + stage.baseline.tau_h * step / kTick_s, coming);
    depth = next;
  }
  return tabled(std::move(volts));
}

OfTime rate_limited(const OfTime& target, double speed, double seconds) {
  std::vector<double> limited(ticks_of(seconds));
  const double most = speed * kTick_s;
  double now = 0.0;
  for (std::size_t k = 0; k < limited.size(); ++k) {
    now += std::clamp(target(static_cast<double>(k) * kTick_s) - now, -most, most);
    limited[k] = now;
  }
  return tabled(std::move(limited));
}

}  // namespace biopsy::sim::paper
