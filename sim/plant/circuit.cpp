#include "sim/plant/circuit.hpp"

#include <algorithm>

namespace biopsy::sim {
namespace {

// Integral over t' from 0 to t of exp(-a (t - t')) exp(-b t'): what is left at t of an input that fades with
// b when what it adds fades with a. Finite also where a = b.
double faded_sum(double a, double b, double t) {
  const double slow = std::min(a, b), apart = std::abs(a - b) * t;
  return std::exp(-slow * t) * t * (apart > 1e-12 ? -std::expm1(-apart) / apart : 1.0);
}

// The amplifier on its way: u_i' = slope + missing/lag exp(-t/lag).
struct Glide {
  double slope = 0.0;    // V/s
  double missing = 0.0;  // V
  double lag = 1.0;      // s
};

Potentials glided(const PlantModel& model, const Potentials& p, const Glide& g, double t) {
  const Baseline& b = model.baseline;
  const double out = 1.0 / b.tau;
  double in = 1.0 / g.lag;
  if (std::abs(out - in) < 1e-5 * out) in = (1.0 - 1e-5) * out;  // below it divides by their difference
  const double push = b.K * g.missing * in;
  Potentials end;
  end.u_i = p.u_i + g.slope * t - g.missing * std::expm1(-in * t);
  end.u_o = p.u_o * std::exp(-out * t) + b.K * g.slope * faded_sum(out, 0.0, t);
  if (g.missing != 0.0) end.u_o += push * faded_sum(out, in, t);
  const auto& charge = model.effects.charge_retention;
  if (!charge) return end;
  // u_o is a sum of exponentials, decaying, constant and approaching; the screening is driven by each.
  const double level = b.K * g.slope * b.tau, approach = push / (out - in), follow = 1.0 / charge->time;
  const double driven = (p.u_o - level - approach) * faded_sum(follow, out, t) +
                        level * faded_sum(follow, 0.0, t) + approach * faded_sum(follow, in, t);
  end.screened = p.screened * std::exp(-follow * t) + charge->share * follow * driven;
  return end;
}

}  // namespace

double amplifier_slope(const PlantModel& model, double u_i, double asked) {
  const auto& lag = model.effects.amplifier_lag;
  if (!lag || lag->instant() || u_i == asked) return 0.0;
  const double missing = std::abs(asked - u_i);
  const double free = lag->time > 0.0 ? missing / lag->time : HUGE_VAL;
  return std::copysign(lag->slew > 0.0 ? std::min(free, 1.0 / lag->slew) : free, asked - u_i);
}

Fading fading(const PlantModel& model, double t) {
  const double tau = model.baseline.tau;
  Fading f{.u_o = std::exp(-t / tau)};
  if (const auto& charge = model.effects.charge_retention) {
    f.screened = std::exp(-t / charge->time);
    f.driven = charge->share / charge->time * faded_sum(1.0 / charge->time, 1.0 / tau, t);
  }
  return f;
}

Potentials after(const PlantModel& model, const Potentials& from, double asked, double t) {
  const auto& lag = model.effects.amplifier_lag;
  Potentials p = from;
  double left = t;
  if (lag->slew > 0.0) {  // limited until what is missing is a lag's worth of the slope
    const double limited = std::abs(asked - p.u_i) * lag->slew - lag->time;
    const double ramp = std::clamp(limited, 0.0, t);
    if (ramp > 0.0) p = glided(model, p, {std::copysign(1.0 / lag->slew, asked - p.u_i), 0.0, 1.0}, ramp);
    left -= ramp;
    if (left > 0.0 && lag->time <= 0.0) p.u_i = asked;  // arrived, but for rounding
  }
  if (left <= 0.0) return p;
  return glided(model, p, lag->time > 0.0 ? Glide{0.0, asked - p.u_i, lag->time} : Glide{}, left);
}

}  // namespace biopsy::sim
