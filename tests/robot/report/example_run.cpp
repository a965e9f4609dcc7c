#include "tests/robot/report/example_run.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace biopsy::report {
namespace {

constexpr double kMmPerPixel = 0.6;
constexpr int kWidth = 220, kHeight = 180;
constexpr double kEntryX = 118.5, kEntryY = 70.5;
const double kAxisX = std::sin(0.25), kAxisY = std::cos(0.25);

SliceGeometry geometry() {
  return {kEntryX, kEntryY, kAxisX, kAxisY, kMmPerPixel};
}

// An oval body, tissue in two greys, noise; a dark needle track down to `needle_mm` where it is not negative.
Picture slice(double needle_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 5.0);
  Picture picture = Picture::blank(kWidth, kHeight, kMmPerPixel);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double u = (x - 110) / 95.0, v = (y - 92) / 74.0,
                   along = ((x - kEntryX) * kAxisX + (y - kEntryY) * kAxisY);
      const double across = (x - kEntryX) * kAxisY - (y - kEntryY) * kAxisX, depth_mm = along * kMmPerPixel;
      double grey = u * u + v * v < 1 ? 105 + 25 * std::sin(x * 0.11) * std::cos(y * 0.07) : 12;
      if (depth_mm > 2.0 && u * u + v * v < 0.8) grey += 35;
      if (needle_mm >= 0 && depth_mm < needle_mm && depth_mm > -38 && std::abs(across) < 1.6) grey *= 0.2;
      const auto level = static_cast<std::uint8_t>(std::clamp(grey + noise(random), 0.0, 255.0));
      for (std::size_t channel = 0; channel < 3; ++channel)
        picture.rgb[3 * static_cast<std::size_t>(y * kWidth + x) + channel] = level;
    }
  return picture;
}

Plan plan() {
  Plan plan;
  plan.target = {"TCGA-0001", "1.2.840.113619.2.55.3.4", Point(12.0, -20.0, 30.0), Point(12.0, -16.5, 30.0)};
  plan.target_depth = Millimetres(3.5);
  plan.axis_offset = Millimetres(0.04);
  plan.layers = {{"muscle", Millimetres(0), Millimetres(2.0)},
                 {"gap", Millimetres(2.0), Millimetres(2.9)},
                 {"liver", Millimetres(2.9), Millimetres(12.0)}};
  plan.steps = {{StepKind::Waypoint, Millimetres(2.0), MillimetresPerSecond(2.0), Volts(5200), Seconds(1),
                 true, "stop short of muscle | gap at 2.00 mm"},
                {StepKind::Target, Millimetres(3.5), MillimetresPerSecond(0.5), Volts(7600), Seconds(1), true,
                 "depth of the biopsy"}};
  plan.limits = {Millimetres(4.5), Volts(7600), {}};
  for (std::size_t i = 0; i < plan.seal.size(); ++i) plan.seal[i] = static_cast<std::uint8_t>(37 * i + 11);
  return plan;
}

Mode mode_at(double t) {
  if (t < 0.5) return Mode::Safe;
  if (t < 1.0) return Mode::Ready;
  if (t < 1.5) return Mode::Armed;
  if (t < 8.0) return Mode::Active;
  if (t < 11.0) return Mode::Hold;
  if (t < 20.0) return Mode::Active;
  if (t < 23.0) return Mode::Hold;
  return Mode::Retract;
}

// First-order depth behind the setpoint, drive from a slow integrator, 2 Hz square wave, 10 um laser noise.
std::vector<Sample> samples() {
  std::mt19937 random(7);
  std::normal_distribution<double> laser(0.0, 0.01);
  std::vector<Sample> samples(25'000);
  double setpoint = 0, tip = 0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const double t = static_cast<double>(k) * 1e-3;
    const Mode mode = mode_at(t);
    const bool second = t >= 11.0, back = mode == Mode::Retract;
    const double goal = back || t < 1.5 ? 0.0 : second ? 3.5 : 2.0;
    setpoint += std::clamp(goal - setpoint, back ? -0.01 : 0.0, second ? 0.0005 : 0.002);
    const double lag = back ? 0.25 : 0.12;
    tip += (setpoint + (second ? 0.05 * std::exp(-(t - 18.2) * (t - 18.2)) : 0.0) - tip) * 1e-3 / lag;
    const double amplitude =
        back ? 1.2 * std::exp(-(t - 23.0) * 4) : 1.9 * std::sqrt(std::max(0.0, tip)) * 1.9;
    Sample& s = samples[k];
    s.time_ms = static_cast<double>(k);
    s.setpoint_mm = static_cast<float>(setpoint);
    s.depth_mm = static_cast<float>(std::round((tip + laser(random)) * 1e3) * 1e-3);
    s.tip_mm = static_cast<float>(tip);
    s.plate_b_mm = static_cast<float>(tip + 0.4);
    s.drive_kV = static_cast<float>(std::round(amplitude * 1e6) * 1e-6 * (k / 250 % 2 ? -1 : 1));
    s.envelope_kV = mode == Mode::Active ? (second ? 7.6F : 5.2F) : static_cast<float>(std::abs(s.drive_kV));
    s.monitor_kV = static_cast<float>(s.drive_kV + 0.002 * laser(random));
    s.current_uA = static_cast<float>(4 * laser(random));
    s.mode = mode;
    s.stop = mode == Mode::Hold ? StopCategory::C2Hold : back ? StopCategory::C1Ramp : StopCategory::None;
    s.step = second ? 1 : 0;
    s.verdict = t < 1.5 ? GateVerdict::NoPermit : GateVerdict::Granted;
  }
  return samples;
}

StepResult step_result(const InsertionStep& step, double reached_s, double depth_mm, double image_mm,
                       std::string layer) {
  StepResult result;
  result.step = step;
  result.reached = true;
  result.reached_s = reached_s;
  result.image_s = reached_s + 1.6;
  result.depth_mm = depth_mm;
  result.rmse_settled_mm = 0.0213;
  result.overshoot_mm = 0.047;
  result.layer_at_tip = std::move(layer);
  result.check = DepthCheck{DepthVerdict::Accept,
                            "Tip found 0.02 mm from where it was expected.",
                            true,
                            Millimetres(image_mm),
                            Millimetres(0.06),
                            0.2,
                            0.1,
                            0.4,
                            0.3,
                            true,
                            0.0,
                            0.05,
                            {0.8, -0.3, 0.1},
                            {0.2, 0.0, -0.4},
                            0.973,
                            11.2};
  result.before = slice(-1, 3);
  result.after = slice(image_mm, 4);
  result.geometry = geometry();
  return result;
}

}  // namespace

RunRecord example_run() {
  RunRecord record;
  record.title = "Liver sampling: 2.0 mm, then 3.5 mm";
  record.outcome = Outcome::Completed;
  record.series = {"DOE^JANE",  "TCGA-0001", "1.2.840.1",  "1.2.840.113619.2.55.3.4",
                   "1.2.840.9", "MR",        "t2_tse_sag", "2019-04-02"};
  record.image_source = "cases/liver/planning";
  record.image_warnings = {"Slice 12: window width is missing; the full range is shown."};
  record.plan = plan();
  record.planning_slice = slice(-1, 2);
  record.planning_geometry = geometry();
  record.samples = samples();
  record.steps = {step_result(record.plan->steps[0], 4.2, 2.004, 1.98, "muscle"),
                  step_result(record.plan->steps[1], 19.1, 3.508, 3.49, "liver")};
  record.steps[0].image_path = "stage-1-image";
  record.steps[1].image_path = "stage-2-image";
  record.limits = {
      {"Drive voltage", 6.77, 8.0, "kV"}, {"Drive voltage, envelope of the plan", 6.77, 7.6, "kV"},
      {"Depth, plan", 3.55, 4.5, "mm"},   {"Depth, stroke", 3.55, 12.0, "mm"},
      {"Time in Hold", 3.0, 10.0, "s"},   {"Fiducial registration error", 0.97, 1.0, "mm"}};
  record.final_depth_mm = 3.508;
  record.left_depth_mm = 0.04;
  record.image_depth_mm = 3.49;
  record.image_depth_sigma_mm = 0.06;
  record.layer_at_tip = "liver";
  record.rmse_settled_mm = 0.0213;
  record.rmse_all_mm = 0.188;
  record.overshoot_mm = 0.047;
  record.peak_kV = 6.77;
  record.simulated_s = 25.0;
  record.wall_s = 0.84;
  record.seed = 42;
  record.provenance = {
      {"biopsy", "0.1.0"},
      {"compiler", "g++ 12.2"},
      {"case file, SHA-256", "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"}};
  return record;
}

RunRecord example_refusal() {
  RunRecord record;
  record.title = "Target beside the axis";
  record.outcome = Outcome::Refused;
  record.refusal = "the target lies 4.2 mm beside the needle's axis; 0.5 mm is allowed";
  record.remedy = "Move the robot or choose a target within 0.5 mm of the axis";
  record.series = example_run().series;
  return record;
}

RunRecord example_stop() {
  RunRecord record = example_run();
  record.outcome = Outcome::Stopped;
  record.refusal = "the laser lost its target for 20 ms";
  record.remedy = "Clean the window of the laser and run the self-test";
  record.trips = {{13.2, StopCategory::C1Ramp, "laser invalid for 20 ms"},
                  {13.6, StopCategory::C0Off, "ramp did not end within 300 ms"}};
  for (Sample& s : record.samples)
    if (s.time_ms >= 13'200) {
      s.mode = s.time_ms < 13'600 ? Mode::Trip : Mode::Lock;
      s.stop = s.time_ms < 13'600 ? StopCategory::C1Ramp : StopCategory::C0Off;
      s.drive_kV = s.envelope_kV = s.monitor_kV = 0;
      s.depth_mm = s.tip_mm = 2.4F * std::exp(-static_cast<float>(s.time_ms - 13'200.0) * 2e-3F);
    }
  record.steps[1].reached = false;
  record.steps[1].reached_s = record.steps[1].image_s = record.steps[1].depth_mm = kUnknown;
  record.steps[1].rmse_settled_mm = record.steps[1].overshoot_mm = kUnknown;
  record.steps[1].check.reset();
  record.steps[1].before = record.steps[1].after = {};
  record.final_depth_mm = 0.02;
  record.layer_at_tip = "muscle";
  record.image_depth_mm = record.image_depth_sigma_mm = kUnknown;
  return record;
}

}  // namespace biopsy::report
