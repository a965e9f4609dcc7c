#include "sim/plant/circuit.hpp"

#include <algorithm>
#include <cmath>

namespace biopsy::sim {
namespace {

// Integral over t' from 0 to t of exp(-a (t - t')) exp(-b t'): response of a first-order lag of rate a to an
// input that decays with rate b. Finite also where a = b.
double decay_response(double a, double b, double t) {
  const double slow = std::min(a, b), apart = std::abs(a - b) * t;
  return std::exp(-slow * t) * t * (apart > 1e-12 ? -std::expm1(-apart) / apart : 1.0);
}

std::optional<Screening> screening_of(const Effects& effects) {
  std::optional<Screening> screening;
  for_each_present(effects, [&]<class E>(const E& effect) {
    if constexpr (requires { &E::screening; }) screening = effect.screening();
  });
  return screening;
}

}  // namespace

double amplifier_slope(const AmplifierDynamics& amplifier, double u_i, double u_command) {
  if (amplifier.instant() || u_i == u_command) return 0.0;
  const double missing = std::abs(u_command - u_i);
  const double free = amplifier.time > 0.0 ? missing / amplifier.time : HUGE_VAL;
  return std::copysign(amplifier.slew > 0.0 ? std::min(free, 1.0 / amplifier.slew) : free, u_command - u_i);
}

Circuit::Circuit(const PlantModel& model)
    : amplifier_(amplifier_dynamics(model.effects)),
      screening_(screening_of(model.effects)),
      instant_(amplifier_.instant()),
      K_0_(model.baseline.K),
      tau_0_(model.baseline.tau) {}

Circuit::Decay Circuit::decay(double t) const {
  Decay out{.u_o = std::exp(-t / tau_)};
  if (screening_) {
    out.screened = std::exp(-t / screening_->time);
    out.charging =
        screening_->share / screening_->time * decay_response(1.0 / screening_->time, 1.0 / tau_, t);
  }
  return out;
}

CircuitState Circuit::ramped(const CircuitState& c, const Ramp& ramp, double t) const {
  const double out = 1.0 / tau_;
  double in = 1.0 / ramp.lag;
  if (std::abs(out - in) < 1e-5 * out) in = (1.0 - 1e-5) * out;  // below it divides by their difference
  const double push = K_ * ramp.missing * in;
  CircuitState end;
  end.u_i = c.u_i + ramp.slope * t - ramp.missing * std::expm1(-in * t);
  end.u_o = c.u_o * std::exp(-out * t) + K_ * ramp.slope * decay_response(out, 0.0, t);
  if (ramp.missing != 0.0) end.u_o += push * decay_response(out, in, t);
  if (!screening_) return end;
  // u_o is a sum of exponentials, decaying, constant and approaching; the screening is driven by each.
  const double level = K_ * ramp.slope * tau_, approach = push / (out - in), follow = 1.0 / screening_->time;
  const double driven = (c.u_o - level - approach) * decay_response(follow, out, t) +
                        level * decay_response(follow, 0.0, t) + approach * decay_response(follow, in, t);
  end.screened = c.screened * std::exp(-follow * t) + screening_->share * follow * driven;
  return end;
}

CircuitState Circuit::after(const CircuitState& from, double t) const {
  const auto& [time, slew] = amplifier_;
  CircuitState c = from;
  double left = t;
  if (slew > 0.0) {  // the slope is limited until what is missing is a lag's worth of it
    const double limited = std::abs(u_command_ - c.u_i) * slew - time;
    const double ramp = std::clamp(limited, 0.0, t);
    if (ramp > 0.0) c = ramped(c, {std::copysign(1.0 / slew, u_command_ - c.u_i), 0.0, 1.0}, ramp);
    left -= ramp;
    if (left > 0.0 && time <= 0.0) c.u_i = u_command_;  // arrived, but for rounding
  }
  if (left <= 0.0) return c;
  return ramped(c, time > 0.0 ? Ramp{0.0, u_command_ - c.u_i, time} : Ramp{}, left);
}

}  // namespace biopsy::sim
