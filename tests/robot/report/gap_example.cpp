#include "tests/robot/report/gap_example.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace biopsy::report {
namespace {

constexpr double kNoise = 0.010;  // mm
constexpr std::size_t kPoints = 1600;

// Play: what friction against a soft spring does to a slow path. `half` in mm.
class Play {
 public:
  explicit Play(double half) : half_(half) {}
  double follow(double x) { return held_ = std::clamp(held_, x - half_, x + half_); }

 private:
  double half_, held_ = 0;
};

using Path = std::function<double(double)>;

// 40 s of a slow triangle with a polarity reversal every second; regimes: 0 after a reversal, 1 rising,
// 2 falling, 3 holding.
GapTrace trace(const std::string& run, bool held_out, double period, std::uint64_t seed, Path wrong) {
  GapTrace t{run, held_out, {}, {}, {}, {}, {}, {}};
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, kNoise);
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double time = 40.0 * static_cast<double>(i) / (kPoints - 1);
    const double phase = std::fmod(time, period) / period;
    const double path = 1.2 * (phase < 0.5 ? 2 * phase : 2 - 2 * phase) + 0.4;
    const double turned = std::fmod(phase, 0.5) * period;  // s since the path last turned
    t.time.push_back(time);
    t.input.push_back((std::fmod(time, 2.0) < 1.0 ? 1 : -1) * (2.5 + 2.2 * path));
    t.after.push_back(wrong(path));
    t.before.push_back(path);
    t.measured.push_back(t.after.back() + noise(random));
    t.regime.push_back(static_cast<std::uint8_t>(turned < 0.12 * period ? 0 : phase < 0.5 ? 1 : 2));
  }
  return t;
}

constexpr const char* kModel =
    "# The paper's equations\ntitle = \"SE-HASEL needle stage, baseline\"\n\n[baseline]\nK = 0.80\ntau = "
    "6.9\n"
    "eps_film = 3.4\nd_film = 100e-6\nL0 = 0.060\nV0 = 1.9e-7\nH_0 = 0.35e-3\nn = 11\ntau_h = 0.030\nk = "
    "140\n"
    "c_k = 0.05\nc_s = 0.60\nfixture_mass = 0.030\nm_B = 0.030\nC1 = 2.0e-9\nT = 1e-3\ng = 9.81\n";

GapFinding common() {
  GapFinding f;
  f.dataset = "Needle stage, bench 2, four ramps with 20 to 100 g";
  f.noise_floor = kNoise;
  f.noise_given = true;
  f.regime_names = {"after_reversal", "rising", "falling", "holding"};
  f.training_runs = {"ramp-20g", "ramp-50g", "steps-50g"};
  f.held_out_runs = {"ramp-100g"};
  f.model_before = f.model_after = kModel;
  f.seconds = 21.4;
  return f;
}

}  // namespace

GapFinding example_effect() {
  GapFinding f = common();
  f.verdict = GapVerdict::Effect;
  f.sentence =
      "Plate A sticks: Coulomb friction of 0.0300 ± 0.0010 N. It explains 98 % of the disagreement, which is "
      "concentrated where the plate turns around.";
  f.effects = {{"coulomb_friction",
                "A constant force opposes the motion of plate A, and holds it while it stands.",
                0.97,
                0.98,
                {{"force_N", 0.030, 0.001}},
                {{"stribeck_friction", 0.02}}}};
  f.rmse_before = 0.1302;
  f.rmse_after = 0.0112;
  f.gap_closed = 0.9900;
  f.where = {{"after_reversal", 0.11, 0.62, 0.310, 0.0115}, {"run:ramp-100g", 0.25, 0.41, 0.171, 0.0112},
             {"falling", 0.42, 0.47, 0.140, 0.0113},        {"deep", 0.38, 0.40, 0.131, 0.0110},
             {"rising", 0.40, 0.36, 0.121, 0.0114},         {"holding", 0.07, 0.01, 0.021, 0.0104}};
  f.candidates = {{"coulomb_friction", CandidateKind::Effect, 1, 0.91, true, 0.0112, 0.97, true},
                  {"stribeck_friction", CandidateKind::Effect, 1, 0.91, true, 0.0113, 0.02, false},
                  {"backlash", CandidateKind::Effect, 1, 0.74, true, 0.0331, 0.01, false},
                  {"zipping_hysteresis", CandidateKind::Effect, 1, 0.55, true, 0.0614, 0.0, false},
                  {"c_s", CandidateKind::Parameter, 1, 0.31, true, 0.1011, 0.0, false}};
  for (const char* name : {"quadratic_damping", "spring_hardening", "added_mass", "sensor_lag", "end_stop",
                           "pouch_creep", "charge_retention"})
    f.candidates.push_back({name, CandidateKind::Effect, 1, 0.04, false});
  f.candidates.push_back({"tau", CandidateKind::Parameter, 1, 0.02, false});
  f.candidates.push_back({"stribeck_friction", CandidateKind::Effect, 2, 0.02, true, 0.0112, 0.08, false});
  f.candidates.push_back({"external_force", CandidateKind::Effect, 2, 0.01, true, 0.0112, 0.05, false});
  const auto play = [](double period, std::uint64_t seed, const char* run, bool held_out) {
    return trace(run, held_out, period, seed, [p = Play(0.14)](double x) mutable { return p.follow(x); });
  };
  f.traces = {play(10, 1, "ramp-50g", false), play(2, 2, "triangle-20g", false),
              play(8, 3, "ramp-100g", true)};
  f.next = {"slow_triangle",
            {"coulomb_friction", "stribeck_friction"},
            0.043,
            "Ramp DC from 0 to 5 kV within 5 s and back. There they differ by 0.043 mm, 4.3 times the "
            "scatter of a reading."};
  f.margins = {{"liver-3.5mm", "tracking_error", "mm", 0.10, 0.031, 0.062, true},
               {"liver-3.5mm", "overshoot", "mm", 0.10, 0.042, 0.118, false},
               {"liver-3.5mm", "peak_drive", "kV", 7.0, 6.1, 6.4, true}};
  f.model_after = kModel;
  f.model_after +=
      "\n[effect.coulomb_friction]\nforce_N = { value = 0.030, std = 0.001, source = \"gap: bench 2\" }\n";
  f.warnings = {"run steps-50g: 3 samples are missing at 12.4 s"};
  return f;
}

GapFinding example_parameter() {
  GapFinding f = common();
  f.verdict = GapVerdict::Parameter;
  f.sentence = "Nothing is missing: the gain K is 0.864 and not 0.80, and the films are 104 µm thick.";
  f.parameters_changed = {{"K", 0.80, 0.864, 0.0021}, {"d_film", 100e-6, 104e-6, 0.9e-6}};
  f.rmse_before = 0.152;
  f.rmse_after = 0.0104;
  f.gap_closed = 0.997;
  f.where = {{"high_voltage", 0.21, 0.48, 0.22, 0.0104}, {"rising", 0.40, 0.41, 0.15, 0.0104}};
  f.candidates = {{"K", CandidateKind::Parameter, 1, 0.96, true, 0.0131, 0.99, true},
                  {"polarity_asymmetry", CandidateKind::Effect, 1, 0.41, true, 0.0741, 0.01, false},
                  {"d_film", CandidateKind::Parameter, 2, 0.61, true, 0.0104, 0.98, true}};
  f.traces = {trace("ramp-100g", true, 10, 5, [](double x) { return 1.16 * x; })};
  const std::size_t at = f.model_after.find("K = 0.80");
  f.model_after.replace(at, 8, "K = { value = 0.864, std = 0.0021 }");
  return f;
}

GapFinding example_no_gap() {
  GapFinding f = common();
  f.sentence = "Model and measurement agree to within the noise of 0.010 mm; nothing is missing.";
  f.rmse_before = f.rmse_after = 0.0101;
  f.traces = {trace("ramp-100g", true, 10, 4, [](double x) { return x; })};
  return f;
}

GapFinding example_unexplained() {
  GapFinding f = common();
  f.verdict = GapVerdict::Unexplained;
  f.sentence =
      "Something is missing that no effect of the library explains: 93 % of the disagreement remains. It "
      "depends most on the position.";
  f.noise_given = false;
  f.rmse_before = 0.094;
  f.rmse_after = 0.091;
  f.gap_closed = 0.036;
  f.where = {{"deep", 0.33, 0.71, 0.14, 0.13}, {"rising", 0.40, 0.52, 0.11, 0.10}};
  f.candidates = {{"end_stop", CandidateKind::Effect, 1, 0.21, true, 0.0911, 0.31, false},
                  {"spring_hardening", CandidateKind::Effect, 1, 0.18, true, 0.0921, 0.28, false}};
  const auto ripple = [](double x) { return x + 0.12 * std::sin(2 * std::numbers::pi * x / 0.5) * x; };
  f.traces = {trace("ramp-100g", true, 10, 6, ripple)};
  f.traces[0].after = f.traces[0].before;
  ResidualShape position{"position", "mm", 0.88, {}, {}, {}}, speed{"speed", "mm/s", 0.07, {}, {}, {}};
  for (int i = 0; i < 40; ++i) {
    const double x = 0.4 + 0.03 * i;
    position.at.push_back(x);
    position.mean.push_back(ripple(x) - x);
    position.count.push_back(40);
    speed.at.push_back(0.02 * (i - 20));
    speed.mean.push_back(0.001 * (i - 20));
    speed.count.push_back(i == 20 ? 0 : 40 + i);
  }
  f.shapes = {position, speed};
  f.next = {"voltage_staircase",
            {},
            0.0,
            "Steps up and down separate what depends on position from what depends on speed."};
  return f;
}

}  // namespace biopsy::report
