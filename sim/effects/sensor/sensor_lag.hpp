#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "sim/effects/effect.hpp"

namespace biopsy::sim {

// First-order lag, then a pure delay as Pade's all-pass of second order: accurate for what changes little
// within the delay, with two states instead of a history.
struct SensorLag {
  double time = 0.0;   // s, first order
  double delay = 0.0;  // s, pure

  struct State {
    double lagged = 0.0;       // m, output of the first order, input of the delay
    double w = 0.0, Dw = 0.0;  // m, the delay's input through 1/(1 + s D/2 + s^2 D^2/12), and D dw/dt
  };

  // First order: the output after h, the input going straight from `from` to `to`. Exact.
  double lagged(double from, double to, double output, double h) const {
    if (time <= 0.0) return to;
    const double trail = (to - from) / h * time;
    return to - trail + (output - from + trail) * std::exp(-h / time);
  }

  // The state after h, the delay's input having gone straight from `from` to `to`. Exact: in units of the
  // delay its equation is w'' + 6 w' + 12 w = 12 input, with roots -3 +- i sqrt(3).
  State delayed(double from, double to, const State& before, double h) const {
    if (delay <= 0.0) return {to, to, 0.0};
    const double slope = (to - from) / h * delay, span = h / delay;
    const double W = before.w - (from - 0.5 * slope), Q = before.Dw - slope;
    const double fade = std::exp(-3.0 * span), c = std::cos(std::numbers::sqrt3 * span),
                 s = std::sin(std::numbers::sqrt3 * span);
    return {to, to - 0.5 * slope + fade * (W * c + (Q + 3.0 * W) / std::numbers::sqrt3 * s),
            slope + fade * (Q * c - std::numbers::sqrt3 * (Q + 4.0 * W) * s)};
  }

  double filtered(const State& own) const { return own.lagged - own.Dw; }
  void follow(double from, double to, double h, State& own) const {
    own = delayed(own.lagged, lagged(from, to, own.lagged, h), own, h);
  }
  void settle(const SteadyMotion& now, State& own) const {
    own.lagged = now.target - now.v * time;
    own.w = own.lagged - 0.5 * now.v * delay;
    own.Dw = now.v * delay;
  }
  void shift(double dx, State& own) const {
    own.lagged += dx;
    own.w += dx;
  }

  static constexpr bool linearises = true;
  static constexpr EffectInfo info{
      "sensor_lag",
      Attachment::Sensor,
      "The reading is late.",
      "dy/dt = (x - y)/time; reading = y exp(-s delay), Pade (2, 2)",
      "weight_drop",
      "averaging and transfer inside a laser triangulation sensor; Golub, Van Loan "
      "2013, sec. 9.3: Pade approximation"};
  static constexpr auto parameters() {
    using E = SensorLag;
    return std::array{Parameter<E>{"time_ms", &E::time, 1e-3, 0.0, 1e4, 5.0, "time constant", Role::Strength},
                      Parameter<E>{"delay_ms", &E::delay, 1e-3, 0.0, 1e4, 2.0,
                                   "pure delay; may be left out of a file", Role::Strength, kMayBeLeftOut}};
  }
};

}  // namespace biopsy::sim
