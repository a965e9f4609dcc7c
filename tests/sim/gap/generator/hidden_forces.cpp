#include "tests/sim/gap/generator/hidden_forces.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace biopsy::hidden {
namespace {
constexpr double kBend = 1.0e-6;  // m, bristles of shaft and side load at sliding
constexpr double kShockSeconds = 6e-3;
constexpr double kCollapseSeconds = 8e-3;
constexpr double kCutting = 0.3;   // of the puncture force remains
constexpr double kEven = 4e-3;     // m, where the even part of the spring levels off: stays stable
constexpr double kKnee = 20e-6;    // m, over which a second spring is reached
constexpr double kValve = 0.2e-3;  // m/s, over which a valve closes
constexpr double kFullLength =
    5e-3;  // m of insertion at which the shaft's bristles are as stiff as the slider's
}  // namespace

double Bristle::advance(double v, double level, double stiffness, double mass, double h) {
  if (level <= 0.0) return bend_ = 0.0;
  const double limit = level / stiffness;
  const double side = v < 0.0 ? -limit : limit;
  bend_ = side + (bend_ - side) * std::exp(-std::abs(v) * h / limit);
  const double rate = v - std::abs(v) * bend_ / limit;
  return stiffness * bend_ + 0.6 * std::sqrt(stiffness * mass) * rate;
}

HiddenForces::HiddenForces(const HiddenPhysics& physics, double mass, std::uint64_t seed)
    : p_(physics), mass_(mass), phase_(physics.wave_phase), dice_(seed) {
  const double drawn = dice_.between(0.0, 2.0 * std::numbers::pi);
  if (p_.wave_phase_by_run) phase_ = drawn;
  next_shock_ = dice_.between(0.5, 2.5);
}

double HiddenForces::spring(double stiffness, double deflection, double rate, double h) {
  const double even = deflection / kEven;
  double force = stiffness * p_.spring_asymmetry * deflection * deflection / (1.0 + even * even);
  force += p_.cubic * deflection * deflection * deflection;
  if (p_.second_spring != 0.0) {
    const double beyond = (std::abs(deflection) - p_.second_at) / kKnee;
    const double reached = kKnee * 0.5 * (beyond + std::sqrt(beyond * beyond + 0.1));
    force += p_.second_spring * stiffness * std::copysign(reached, deflection);
  }
  if (p_.bouc_force > 0.0) {  // A = 1, beta = 0.6 / length, gamma = 0.4 / length: |z| -> length
    const double beta = 0.6 / p_.bouc_length, gamma = 0.4 / p_.bouc_length;
    bouc_ += h * (rate - beta * std::abs(rate) * bouc_ - gamma * rate * std::abs(bouc_));
    force += p_.bouc_force * bouc_ / p_.bouc_length;
  }
  return force;
}

double HiddenForces::tissue(double x, double v, double h) {
  double force = 0.0;
  if (p_.puncture_force > 0.0 && x > p_.puncture_at) {
    const double bulge = (x - p_.puncture_at) / p_.puncture_bulge;
    punctured_ = punctured_ || bulge >= 1.0;
    if (punctured_) collapse_ -= h / kCollapseSeconds * (collapse_ - kCutting);
    const double cutting = std::clamp(v / 1e-3, 0.0, 1.0) * std::min(1.0, bulge);
    if (!punctured_) force += p_.puncture_force * bulge * bulge;
    if (punctured_) force += p_.puncture_force * (collapse_ - kCutting + kCutting * cutting);
  }
  const double inserted = std::max(0.0, x);
  if (p_.shaft_friction > 0.0)
    force +=
        shaft_.advance(v, p_.shaft_friction * inserted, p_.shaft_friction * kFullLength / kBend, mass_, h);
  force += p_.shaft_viscous * inserted * v;
  if (p_.relax_stiffness > 0.0) {  // a spring whose far end creeps after the needle
    const double drive = x > 0.0 ? p_.relax_stiffness * v : 0.0;
    const double half = 0.5 * h / p_.relax_time;
    maxwell_ = ((1.0 - half) * maxwell_ + h * drive) / (1.0 + half);
    force += maxwell_;
  }
  return force;
}

double HiddenForces::shock(double t) {
  if (t > next_shock_ + kShockSeconds) {
    next_shock_ = t + dice_.between(0.3, 3.0);
    shock_sign_ = dice_.uniform() < 0.5 ? -1.0 : 1.0;
  }
  if (t < next_shock_) return 0.0;
  return shock_sign_ * p_.shock_force * std::sin(std::numbers::pi * (t - next_shock_) / kShockSeconds);
}

double HiddenForces::resisting(double t, double x, double v, double drive, double h) {
  double force = p_.push + p_.drag * v * std::abs(v) + tissue(x, v, h);
  if (p_.friction > 0.0) {
    const double slow = v / p_.stribeck_speed;
    const double level = p_.friction * (1.0 + (p_.breakaway_ratio - 1.0) * std::exp(-slow * slow));
    force += slider_.advance(v, level, p_.friction / p_.bristles, mass_, h);
  }
  if (p_.side_load > 0.0) {
    const double level = p_.side_load * std::abs(drive);
    force += side_.advance(v, level, level / kBend, mass_, h);
  }
  if (p_.rope > 0.0) {  // A = 1, beta = 2.1 / length, gamma = -3.1 / length
    const auto rate_of = [&](double z) {
      return v + (3.1 * v - 2.1 * std::copysign(v, z)) * std::abs(z) / p_.rope_length;
    };
    const double middle = rope_ + 0.5 * h * rate_of(rope_);
    rope_ += h * rate_of(middle);
    force += p_.rope * middle;
  }
  if (p_.wave_force > 0.0)
    force += p_.wave_force * std::sin(2.0 * std::numbers::pi * p_.wave_hz * t + phase_);
  if (p_.stop_at > 0.0 && x > p_.stop_at) {  // Hunt and Crossley
    const double deep = x - p_.stop_at;
    force += std::max(0.0, p_.stop_stiffness * deep * std::sqrt(deep) * (1.0 + 2.0 * v));
  }
  if (p_.bump_damping > 0.0) {
    const double off = (x - 1.6e-3) / 0.35e-3;
    force += p_.bump_damping * std::exp(-off * off) * v;
  }
  if (p_.valve > 0.0) force += 0.5 * p_.valve * v * (1.0 - std::tanh(v / kValve));
  if (p_.shock_force > 0.0) force += shock(t);
  return force;
}

}  // namespace biopsy::hidden
