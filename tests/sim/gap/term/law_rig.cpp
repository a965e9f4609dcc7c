#include "tests/sim/gap/term/law_rig.hpp"

#include <cmath>
#include <numbers>

namespace biopsy::hidden {
namespace {

constexpr double kLawRate = 250.0, kLawSeconds = 8.0;  // Hz, s
constexpr int kLawSteps = 12;                          // of the integrator between rows
constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr double kDrive = 2.0;      // N, usual size
constexpr double kFarAway = 8.0;    // usual positions
constexpr double kTurnover = 1e-3;  // m/s, within which dry friction turns over

struct State {
  double x = 0.0, v = 0.0, memory = 0.0;
};

State moved(const State& at, const State& by, double h) {
  return {at.x + h * by.x, at.v + h * by.v, at.memory + h * by.memory};
}

State slope(const LawRig& rig, const State& s, double push) {
  const double w = kFullTurn * rig.hertz;
  const double force = push + rig.law.force({s.x, s.v, push, s.memory});
  return {s.v, force / rig.mass - 2.0 * rig.damping_ratio * w * s.v - w * w * s.x,
          s.v - s.memory / rig.law.memory_time};
}

std::vector<double> motion(const LawRig& rig, const std::vector<double>& push) {
  const double h = 1.0 / kLawRate / kLawSteps;
  State s;
  std::vector<double> out;
  for (const double f : push) {
    out.push_back(s.x);
    for (int i = 0; i < kLawSteps; ++i) {
      const State a = slope(rig, s, f), b = slope(rig, moved(s, a, 0.5 * h), f),
                  c = slope(rig, moved(s, b, 0.5 * h), f), d = slope(rig, moved(s, c, h), f);
      s = moved(moved(moved(moved(s, a, h / 6.0), b, h / 3.0), c, h / 3.0), d, h / 6.0);
    }
  }
  return out;
}

std::vector<double> drive(int run, Dice& dice) {
  const auto rows = static_cast<std::size_t>(kLawRate * kLawSeconds);
  const double peak = dice.between(1.5, 3.0);
  std::vector<double> out(rows, 0.0);
  if (run % 2 == 1) {
    double level = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      if (i % 200 == 0 && i > 0) level = dice.between(-peak, peak);
      out[i] = level;
    }
    return out;
  }
  for (const double hertz : {0.4, 0.9, 1.6, 2.6, 4.1}) {
    const double phase = dice.between(0.0, kFullTurn);
    for (std::size_t i = 0; i < rows; ++i) {
      const double t = static_cast<double>(i) / kLawRate;
      out[i] += 0.35 * peak * std::min(1.0, t) * std::sin(kFullTurn * hertz * t + phase);
    }
  }
  return out;
}

void add_shocks(std::vector<double>& push, double size, Dice& dice) {
  for (auto at = static_cast<std::size_t>(dice.between(20.0, 200.0)); at + 10 < push.size();
       at += static_cast<std::size_t>(dice.between(60.0, 400.0))) {
    const double force = dice.uniform() < 0.5 ? size : -size;
    for (std::size_t i = 0; i < 10; ++i) push[at + i] += force;
  }
}

double usual_position(const LawRig& rig) {
  return kDrive / (rig.mass * std::pow(kFullTurn * rig.hertz, 2));
}

}  // namespace

std::vector<ForceLaw> outside_laws(const LawRig& rig, double share, Dice& dice) {
  const double X = usual_position(rig), V = X * kFullTurn * rig.hertz;
  const double F = share * kDrive, side = dice.uniform() < 0.5 ? -1.0 : 1.0;
  const auto signed_size = [](double v) { return std::tanh(v / kTurnover); };
  return {
      {"cubic_damping", {'v'}, [=](const LawPoint& p) { return -F * std::pow(p.v / V, 3); }},
      {"place_damping", {'x', 'v'}, [=](const LawPoint& p) { return -F * std::pow(p.x / X, 2) * p.v / V; }},
      {"quadratic_spring", {'x'}, [=](const LawPoint& p) { return side * F * std::pow(p.x / X, 2); }},
      {"speed_times_position", {'x', 'v'}, [=](const LawPoint& p) { return side * F * p.x / X * p.v / V; }},
      {"even_drag", {'v'}, [=](const LawPoint& p) { return side * F * std::pow(p.v / V, 2); }},
      {"drive_cubed", {'u'}, [=](const LawPoint& p) { return -0.5 * F * std::pow(p.drive / kDrive, 3); }},
      {"drive_by_place",
       {'x', 'u'},
       [=](const LawPoint& p) { return side * F * p.drive / kDrive * p.x / X; }},
      {"place_friction",
       {'x', 'v'},
       [=](const LawPoint& p) { return -0.5 * F * std::pow(p.x / X, 2) * signed_size(p.v); }},
      {"relaxing_spring",
       {'q'},
       [=](const LawPoint& p) { return -F * p.memory / X; },
       dice.between(0.1, 0.6)},
      {"spring_and_drag",
       {'x', 'v'},
       [=](const LawPoint& p) {
         return side * 0.7 * F * std::pow(p.x / X, 2) - 0.7 * F * std::pow(p.v / V, 3);
       }},
  };
}

std::vector<ForceLaw> sliding_laws(const LawRig& rig, double share, Dice& dice) {
  const double X = usual_position(rig), V = X * kFullTurn * rig.hertz, F = share * kDrive;
  const double period = dice.between(0.5, 0.9) * X, phase = dice.between(0.0, kFullTurn);
  const double power = dice.between(0.4, 0.6), slope = dice.between(0.3, 0.6);
  return {
      {"cogging",
       {'x'},
       [=](const LawPoint& p) { return 0.7 * F * std::sin(kFullTurn * p.x / period + phase); }},
      {"thinning_paste",
       {'v'},
       [=](const LawPoint& p) {
         return -F * p.v / V * std::pow(p.v * p.v / (V * V) + 1e-4, 0.5 * power - 0.5);
       }},
      {"tapered_guide",
       {'x', 'v'},
       [=](const LawPoint& p) { return -0.4 * F * (1.0 + slope * p.x / X) * std::tanh(p.v / kTurnover); }},
  };
}

std::vector<ForceLaw> curved_laws(const LawRig& rig, double share, Dice& dice) {
  const double X = usual_position(rig), V = X * kFullTurn * rig.hertz;
  const double F = share * kDrive, side = dice.uniform() < 0.5 ? -1.0 : 1.0;
  const double at = dice.between(-0.5, 0.5), wide = dice.between(0.5, 1.0);
  return {
      {"rough_place",
       {'x', 'v'},
       [=](const LawPoint& p) { return -2.0 * F * std::exp(-std::pow((p.x / X - at) / wide, 2)) * p.v / V; }},
      {"exponential_spring",
       {'x'},
       [=](const LawPoint& p) {
         const double s = side * p.x / X;
         return -side * F * (std::exp(std::min(s, 4.0)) - 1.0 - s);
       }},
      {"magnet_to_one_side",
       {'x'},
       [=](const LawPoint& p) {
         return side * 8.0 * F / std::pow(3.0 + std::max(-2.0, -side * p.x / X), 2);
       }},
      {"power_law_drag",
       {'v'},
       [=](const LawPoint& p) { return -F * std::copysign(std::pow(std::abs(p.v / V), 2.6), p.v); }},
      {"check_valve",
       {'v'},
       [=](const LawPoint& p) { return -2.0 * F * std::max(0.0, side * p.v / V) * side; }},
      {"saturating_drive",
       {'u'},
       [=](const LawPoint& p) {
         const double most = kDrive / (0.5 + 2.0 * share);
         return most * std::tanh(p.drive / most) - p.drive;
       }},
      {"drag_in_a_cone",
       {'x', 'v'},
       [=](const LawPoint& p) { return -F * p.v / V / std::pow(1.6 + std::tanh(side * p.x / X), 2) * 2.0; }},
      {"coil_leaving_its_magnet",
       {'x', 'u'},
       [=](const LawPoint& p) {
         return -p.drive * share * std::pow(p.x / X, 2) / (1.0 + std::pow(p.x / X, 2));
       }},
  };
}

LawRig drawn_rig(Dice& dice) {
  LawRig out;
  out.mass = dice.between(0.2, 0.8);
  out.hertz = dice.between(1.5, 4.0);
  out.damping_ratio = dice.between(0.05, 0.3);
  return out;
}

sim::Dataset law_recording(const LawRig& rig, double noise, std::uint64_t seed) {
  Dice dice(seed);
  sim::Dataset out;
  out.title = "rig";
  out.sensor_noise = noise;
  for (int r = 0; r < 4; ++r) {
    sim::RecordedRun run;
    run.name = "run" + std::to_string(r);
    run.file = run.name + ".csv";
    run.period = 1.0 / kLawRate;
    run.input = drive(r, dice);
    std::vector<double> push = run.input;
    add_shocks(push, rig.shocks, dice);
    double wander = 0.0;
    const double fading = std::exp(-run.period / 0.7);
    for (const double x : motion(rig, push)) {
      wander = fading * wander + std::sqrt(1.0 - fading * fading) * rig.wander * dice.normal();
      run.time.push_back(static_cast<double>(run.time.size()) / kLawRate);
      run.displacement.push_back(x + wander + noise * dice.normal());
      run.external_force.push_back(0.0);
    }
    out.runs.push_back(std::move(run));
  }
  return out;
}

bool runs_away(const LawRig& rig, const sim::Dataset& recording) {
  for (const sim::RecordedRun& run : recording.runs)
    for (const double x : run.displacement)
      if (!(std::abs(x) < kFarAway * usual_position(rig))) return true;
  return false;
}

std::string law_rig_model(const LawRig& rig, Dice& dice) {
  const double w = kFullTurn * rig.hertz;
  const auto off = [&](double value) { return std::to_string(value * (1.0 + dice.between(-0.015, 0.015))); };
  return "[baseline]\ndrive = \"force\"\nm = " + off(rig.mass) +
         "\nc_s = " + off(2.0 * rig.damping_ratio * w * rig.mass) + "\nk = " + off(w * w * rig.mass) + "\n";
}

}  // namespace biopsy::hidden
