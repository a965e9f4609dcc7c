#include "tests/sim/gap/recordings/rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/gap/generator/hidden_physics.hpp"

namespace biopsy::hidden {
namespace {

constexpr double kRate = 250.0, kSeconds = 8.0;  // Hz, s
constexpr int kSteps = 16;                       // of the integrator between rows
constexpr double kContact = 2e5;                 // N/m, of a contact that holds
constexpr double kRoughWidth = 2e-3;             // m
constexpr double kTwoPi = 2.0 * std::numbers::pi;

std::vector<double> multisine(double peak, Dice& dice) {
  const auto rows = static_cast<std::size_t>(kRate * kSeconds);
  std::vector<double> out(rows, 0.0);
  for (const double f : {0.3, 0.7, 1.3, 2.1, 3.4}) {
    const double phase = dice.between(0.0, kTwoPi);
    for (std::size_t i = 0; i < rows; ++i) {
      const double t = static_cast<double>(i) / kRate;
      out[i] += 0.35 * peak * std::min(1.0, t) * std::sin(kTwoPi * f * t + phase);
    }
  }
  return out;
}

std::vector<double> steps(double peak, Dice& dice) {
  std::vector<double> out;
  double level = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(kRate * kSeconds); ++i) {
    if (i % 250 == 0 && i > 0) level = dice.between(-peak, peak);
    out.push_back(level);
  }
  return out;
}

std::vector<double> ridden(const Rig& rig, const std::vector<double>& force) {
  const double h = 1.0 / kRate / kSteps, w = kTwoPi * rig.hertz;
  double x = 0.0, v = 0.0, anchor = 0.0, t = 0.0;
  const bool touches = rig.grip > 0.0 || rig.side_load > 0.0;
  const auto acceleration = [&](double push, double at, double speed) {
    const double contact = kContact * (at - anchor);
    const double off = (at - rig.rough_at) / kRoughWidth;
    const double drag = rig.rough * std::exp(-off * off) * speed;
    const double from_dent = (at - rig.dent_at) / kRoughWidth;
    const double dented = rig.dent * std::exp(-from_dent * from_dent);
    const double excess = at > rig.second_at ? at - rig.second_at : std::min(0.0, at + rig.second_at);
    const double ratio = rig.damping_ratio * (speed < 0.0 ? 1.0 + rig.valve : 1.0);
    const double lost = rig.softens * (1.0 - std::exp(-t / rig.softens_in));
    return (push - drag + dented - contact * touches) / rig.mass - 2.0 * ratio * w * speed -
           w * w * (at * (1.0 - lost + rig.lopsided * at + rig.stiffening * at * at) + rig.second * excess);
  };
  std::vector<double> out;
  for (const double push : force) {
    out.push_back(x);
    for (int i = 0; i < kSteps; ++i, t += h) {
      const double a = acceleration(push, x, v);
      x += h * (v + 0.5 * h * a);
      const double slides_at = rig.grip + rig.side_load * std::abs(push);
      anchor = std::clamp(anchor, x - (slides_at + rig.one_way) / kContact,
                          x + (slides_at - rig.one_way) / kContact);
      v += 0.5 * h * (a + acceleration(push, x, v + h * a));
    }
  }
  return out;
}

}  // namespace

sim::Dataset rig_recording(const Rig& rig, double noise, std::uint64_t seed) {
  Dice dice(seed);
  sim::Dataset out;
  out.title = "rig";
  out.sensor_noise = noise;
  for (int r = 0; r < 4; ++r) {
    sim::RecordedRun run;
    run.name = "run" + std::to_string(r);
    run.file = run.name + ".csv";
    run.period = 1.0 / kRate;
    const double peak = dice.between(1.5, 3.0);
    run.input = r % 2 == 0 ? multisine(peak, dice) : steps(peak, dice);
    for (const double x : ridden(rig, run.input)) {
      run.time.push_back(static_cast<double>(run.time.size()) / kRate);
      run.displacement.push_back(x + noise * dice.normal());
      run.external_force.push_back(0.0);
    }
    out.runs.push_back(std::move(run));
  }
  return out;
}

sim::Dataset ridden_again(const Rig& rig, sim::Dataset recording, double noise) {
  Dice dice(recording.runs.size());
  for (sim::RecordedRun& run : recording.runs) {
    run.displacement = ridden(rig, run.input);
    for (double& x : run.displacement) x += noise * dice.normal();
  }
  return recording;
}

std::string rig_model(const Rig& rig) {
  const double w = kTwoPi * rig.hertz;
  return "[baseline]\ndrive = \"force\"\nm = " + std::to_string(rig.mass) +
         "\nc_s = " + std::to_string(2.0 * rig.damping_ratio * w * rig.mass) +
         "\nk = " + std::to_string(w * w * rig.mass) + "\n";
}

}  // namespace biopsy::hidden
