#include "tests/bench/blind/blind_cases.hpp"

#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "tests/bench/blind/blind_laws.hpp"

namespace biopsy::blind {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kCalibration = 0.01;  // of each number of the model
constexpr double kStroke = 5e-3, kRunSeconds = 14.0;
constexpr int kRuns = 5;

struct Laboratory {
  StageRig stage;
  MassRig mass;
  double noise = 8e-6, period = 2e-3;
  Sizes sizes{};
};

// A curve between 0 and 1 of one kind or another, beginning at 0.
class Curve {
 public:
  Curve(int kind, Random& random) : kind_(kind) {
    for (double& one : drawn_) one = between(random, 0.0, 1.0);
  }

  double operator()(double t) const {
    const double begin = std::min(1.0, t / 0.8);
    switch (kind_ % 5) {
      case 0: {  // slow sum of three sines
        double sum = 0.0;
        for (std::size_t i = 0; i < 3; ++i)
          sum += std::sin(kTurn *
                          ((0.11 + 0.23 * static_cast<double>(i) + 0.15 * drawn_[i]) * t + drawn_[i + 3]));
        return begin * std::clamp(0.5 + sum / 5.0, 0.0, 1.0);
      }
      case 1:  // stairs of 1.1 s
        return begin * (0.1 + 0.9 * drawn_[static_cast<std::size_t>(t / 1.1) % drawn_.size()]);
      case 2: {  // half-sine pulses with rests between
        const double part = std::fmod(t, 3.1) / 3.1,
                     size = 0.5 + 0.5 * drawn_[static_cast<std::size_t>(t / 3.1)];
        return part < 0.6 ? size * std::sin(std::numbers::pi * part / 0.6) : 0.0;
      }
      case 3: {  // trapezoid
        const double part = std::fmod(t, 6.4) / 6.4;
        return std::clamp(std::min(5.0 * part, 4.2 * (1.0 - part)), 0.0, 0.6 + 0.4 * drawn_[0]);
      }
      default:  // sweep from 0.3 Hz upwards
        return begin * (0.55 - 0.4 * std::cos(kTurn * (0.3 * t + 0.12 * t * t)));
    }
  }

 private:
  int kind_;
  std::array<double, 16> drawn_{};
};

Laboratory drawn_laboratory(const BlindCase& one, Random& random) {
  Laboratory out;
  if (!one.mass_rig) {
    out.period = one.seed % 3 == 0 ? 1e-3 : 2e-3;
    const double volts = voltage_for(out.stage, kStroke, 0.05), mass = out.stage.fixture + 0.05;
    out.sizes = {kStroke, mass * 9.81, 0.03, mass, out.stage.spring, volts};
    return out;
  }
  out.mass.mass = std::exp(between(random, std::log(0.15), std::log(6.0)));
  const double turns = kTurn * between(random, 1.2, 5.0);
  out.mass.spring = out.mass.mass * turns * turns;
  out.mass.loss = 2.0 * between(random, 0.08, 0.35) * out.mass.mass * turns;
  out.period = 4e-3;
  const double stroke = between(random, 4e-3, 12e-3);
  out.noise = between(random, 0.5e-3, 1.5e-3) * stroke;
  out.sizes = {stroke, out.mass.spring * stroke, turns * stroke, out.mass.mass, out.mass.spring, 0.0};
  return out;
}

std::vector<Drive> drives(const Laboratory& lab, bool mass_rig, Random& random) {
  std::vector<Drive> out;
  const int first = static_cast<int>(random() % 5);
  for (int run = 0; run < kRuns; ++run) {
    const Curve curve(first + run, random);
    Drive drive{.period = lab.period,
                .weight = mass_rig ? 0.0 : 1e-3 * std::round(between(random, 15, 125)),
                .input = {}};
    const double turns = between(random, 0.6, 3.0), reach = between(random, 0.75, 1.0);
    for (double t = 0.0; t < kRunSeconds; t += lab.period) {
      if (mass_rig) {
        const double level = curve(t) * std::sin(kTurn * 0.5 * turns * t) + 0.4 * std::sin(1.3 * t);
        drive.input.push_back(1e-4 * std::round(1e4 * 0.7 * reach * lab.sizes.force * level));
        continue;
      }
      const double height = reach * kStroke * curve(t);
      const double volts = height < 0.05e-3 ? 0.0 : voltage_for(lab.stage, height, drive.weight);
      const bool direct = run == 1 || (run == 3 && t > 7.0);
      const double side = direct || std::sin(kTurn * turns * t) >= 0.0 ? 1.0 : -1.0;
      drive.input.push_back(std::round(side * volts));
    }
    out.push_back(std::move(drive));
  }
  return out;
}

const Law& law_of(const BlindCase& one, const std::string& name) {
  const bool outside = one.kind == Kind::Outside;
  const auto& laws = one.mass_rig ? (outside ? outside_mass_laws() : mass_laws())
                                  : (outside ? outside_stage_laws() : stage_laws());
  const auto found = std::ranges::find(laws, name, &Law::name);
  if (found == laws.end()) throw std::invalid_argument("no law named " + name);
  return *found;
}

Seen ride(const Laboratory& lab, bool mass_rig, const Extra& extra, const Drive& drive) {
  return mass_rig ? ride_mass(lab.mass, extra, drive) : ride_stage(lab.stage, extra, drive);
}

std::string model_text(const Laboratory& lab, bool mass_rig, Random& random) {
  const auto guess = [&](double value) { return value * (1.0 + either_sign(random, 0.0, kCalibration)); };
  if (mass_rig)
    return fmt::format("[baseline]\ndrive = \"force\"\nm = {}\nc_s = {}\nk = {}\n", guess(lab.mass.mass),
                       guess(lab.mass.loss), guess(lab.mass.spring));
  const StageRig& s = lab.stage;
  return fmt::format(
      "[baseline]\nK = {}\ntau = {}\neps_film = {}\nd_film = {}\nL0 = {}\nV0 = {}\nH_0 = {}\nn = {}\ntau_h = "
      "{}\n"
      "k = {}\nc_k = {}\nc_s = {}\nfixture_mass = {}\nm_B = {}\nC1 = {}\n",
      guess(s.gain), guess(s.leak_time), s.permittivity, s.film, s.width, guess(s.volume), s.rest_height,
      s.pouches, guess(s.oil_time), guess(s.spring), guess(s.spring_loss), guess(s.slide_loss), s.fixture,
      s.plate_b, s.capacity);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  fmt::output_file(file.string()).print("{}", text);
}

}  // namespace

std::vector<BlindCase> blind_cases(std::uint64_t seed) {
  std::vector<BlindCase> out;
  const auto add = [&](Kind kind, bool mass_rig, std::vector<std::string> effects,
                       const std::string& variables, const std::string& tag) {
    out.push_back({fmt::format("{}{}/{}", mass_rig ? "mass: " : "stage: ", fmt::join(effects, "+"), tag),
                   kind, std::move(effects), variables, mass_rig, seed * 1009 + out.size()});
  };
  for (const char* draw : {"1", "2"}) {
    for (const Law& law : stage_laws()) add(Kind::Single, false, {law.name}, "", draw);
    for (const Law& law : mass_laws()) add(Kind::Single, true, {law.name}, "", draw);
    for (const Law& law : outside_stage_laws()) add(Kind::Outside, false, {law.name}, law.variables, draw);
    for (const Law& law : outside_mass_laws()) add(Kind::Outside, true, {law.name}, law.variables, draw);
    for (const bool mass_rig : {false, false, true, true}) add(Kind::Nothing, mass_rig, {}, "", draw);
  }
  for (const auto& [first, second] :
       std::initializer_list<std::pair<const char*, const char*>>{{"coulomb_friction", "pouch_creep"},
                                                                  {"polarity_asymmetry", "external_force"},
                                                                  {"zipping_hysteresis", "sensor_scale"},
                                                                  {"quadratic_damping", "charge_retention"},
                                                                  {"added_mass", "sensor_drift"}})
    add(Kind::Pair, false, {first, second}, "", "1");
  for (const auto& [first, second] : std::initializer_list<std::pair<const char*, const char*>>{
           {"coulomb_friction", "spring_hardening"}, {"quadratic_damping", "external_force"}})
    add(Kind::Pair, true, {first, second}, "", "1");
  return out;
}

double write_case(const BlindCase& one, const std::filesystem::path& folder) {
  Random random(one.seed * 0x9E3779B97F4A7C15ULL + 1);
  const Laboratory lab = drawn_laboratory(one, random);
  Extra extra;
  for (const std::string& name : one.effects) law_of(one, name).add(extra, random, lab.sizes);
  std::filesystem::create_directories(folder);
  write_text(folder / "model.toml", model_text(lab, one.mass_rig, random));
  std::string toml =
      fmt::format("title = \"recording {}\"\nsensor_noise_mm = {}\n", one.seed, 1e3 * lab.noise);
  std::normal_distribution<double> normal;
  double sum = 0.0, count = 0.0;
  int number = 0;
  for (const Drive& drive : drives(lab, one.mass_rig, random)) {
    const Seen seen = ride(lab, one.mass_rig, extra, drive), bare = ride(lab, one.mass_rig, {}, drive);
    std::string csv =
        one.mass_rig ? "time_s,force_N,displacement_mm\n" : "time_s,voltage_V,displacement_mm,plate_b_mm\n";
    for (std::size_t i = 0; i < drive.input.size(); ++i) {
      const double x = seen.displacement[i] + lab.noise * normal(random);
      fmt::format_to(std::back_inserter(csv), "{:.4f},{:.6g},{:.5f}", static_cast<double>(i) * drive.period,
                     drive.input[i], 1e3 * x);
      if (!one.mass_rig)
        fmt::format_to(std::back_inserter(csv), ",{:.5f}",
                       1e3 * (seen.plate_b[i] + lab.noise * normal(random)));
      csv += '\n';
      sum += std::pow((seen.displacement[i] - bare.displacement[i]) / lab.noise, 2), ++count;
    }
    const std::string name = fmt::format("r{}", ++number);
    toml += fmt::format("\n[[run]]\nname = \"{}\"\nfile = \"{}.csv\"\n", name, name);
    if (!one.mass_rig) toml += fmt::format("weight_g = {}\n", 1e3 * drive.weight);
    write_text(folder / (name + ".csv"), csv);
  }
  write_text(folder / "dataset.toml", toml);
  return std::sqrt(sum / count);
}

}  // namespace biopsy::blind
