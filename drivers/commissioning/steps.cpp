#include "drivers/commissioning/steps.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <limits>

#include "drivers/commissioning/sample_figures.hpp"
#include "robot/common/statistics.hpp"
#include "safety/types/limits.hpp"
#include "safety/types/thresholds.hpp"

namespace biopsy::commissioning {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kSecond = 1'000;        // ticks
constexpr std::size_t kSettle = 3 * kSecond;  // until the plate is at rest
constexpr std::int32_t kTestLevel_mV = 300'000;
constexpr std::int32_t kLevels_mV[] = {200'000, 350'000, 500'000, -200'000, -350'000, -500'000};

std::vector<Sample> rest_for(Rig& rig, std::size_t ticks) {
  std::vector<Sample> samples;
  samples.reserve(ticks);
  for (std::size_t k = 0; k < ticks; ++k) samples.push_back(rig.rest());
  return samples;
}

bool has_voltage(const Sample& sample) {
  return std::abs(sample.reading.monitor_mV) > limits::kZeroVolt_mV;
}

double ms_between(const Sample& first, const Sample& second) {
  return static_cast<double>(second.reading.time_us - first.reading.time_us) * 1e-3;
}

Measured wiring(Rig& rig, Operator&) {
  const std::vector<Sample> seen = rest_for(rig, kSecond);
  return {{share(seen, [](const Sample& s) { return s.reading.laser_valid; }), deviation(seen, depth_mm),
           fewest_codes(seen, safety::kFrozen_ticks), mean(seen, monitor_kV), deviation(seen, monitor_kV),
           mean(seen, milliamperes)},
          {}};
}

Measured laser(Rig& rig, Operator& operator_) {
  const double zero_mm = mean(rest_for(rig, kSecond), depth_mm);
  const bool placed = operator_.confirm(Act::LayBlock, "Lay a gauge block of 2 to 8 mm under plate A.");
  rest_for(rig, kSettle);
  const double block_mm =
      placed ? operator_.enter_value("Height of the block, mm").value_or(kNotMeasured) : kNotMeasured;
  const double read_mm = mean(rest_for(rig, kSecond), depth_mm);
  const bool removed = operator_.confirm(Act::RemoveBlock, "Remove the block, let the plate sink back.");
  rest_for(rig, kSettle);
  const double back_mm = removed ? mean(rest_for(rig, kSecond), depth_mm) : kNotMeasured;
  return {{zero_mm, block_mm, read_mm - zero_mm - block_mm, back_mm}, {}};
}

Measured loop_rate(Rig& rig, Operator&) {
  const std::vector<Sample> seen = rest_for(rig, 10 * kSecond);
  std::vector<double> work_us;
  work_us.reserve(seen.size());
  for (const Sample& sample : seen) work_us.push_back(static_cast<double>(sample.work_us));
  return {
      {share(seen, missed_its_period), most_missed(seen, 100), longest_gap_ms(seen), quantile(work_us, 0.99)},
      fmt::format("a tick's work: p50 {:.0f} us, p99 {:.0f} us, longest {:.0f} us", quantile(work_us, 0.5),
                  quantile(work_us, 0.99), quantile(work_us, 1.0))};
}

Measured monitor_gain(Rig& rig, Operator&) {
  std::vector<double> commands, monitors;
  double largest_mA = 0.0;
  for (const std::int32_t level_mV : kLevels_mV) {
    const Drive drive = rig.drive(level_mV, 250, [](const Sample&) { return true; });
    std::vector<Sample> steady;
    for (const Sample& sample : drive.samples)
      if (sample.command_mV == level_mV) steady.push_back(sample);
    if (!drive.stopped_because.empty() || steady.size() < 200)
      return {{kNotMeasured, kNotMeasured, kNotMeasured, kNotMeasured},
              fmt::format("stopped at {:.2f} kV: {}", level_mV * 1e-6, drive.stopped_because)};
    steady.erase(steady.begin(), steady.begin() + 50);  // the stack charges
    commands.push_back(mean(steady, command_kV));
    monitors.push_back(mean(steady, monitor_kV));
    largest_mA = std::max(largest_mA, std::abs(mean(steady, milliamperes)));
  }
  const Line line = line_through(commands, monitors);
  return {{line.gain, line.offset, line.largest_residual, largest_mA}, {}};
}

// Stops the pulse of one half of the interlock under voltage. Time: from its last pulse to the first reading
// without voltage while the converter still gives it.
Measured interlock_without(Rig& rig, void (Rig::*feed)(bool)) {
  std::uint32_t tick = 0;
  const Drive drive = rig.drive(kTestLevel_mV, 200, [&](const Sample& sample) {
    if (++tick == 100) (rig.*feed)(false);
    return tick < 105 || has_voltage(sample);
  });
  (rig.*feed)(true);
  if (drive.samples.size() < 100) return {{kNotMeasured, kNotMeasured}, drive.stopped_because};
  const Sample& last_fed = drive.samples[99];
  for (const Sample& sample : drive.samples)
    if (sample.reading.time_us > last_fed.reading.time_us && !has_voltage(sample) &&
        sample.command_mV == kTestLevel_mV)
      return {{monitor_kV(last_fed), ms_between(last_fed, sample)}, {}};
  return {{monitor_kV(last_fed), kNotMeasured},
          "the voltage stayed until the program ended it: no interlock opened"};
}

Measured drivers_half(Rig& rig, Operator&) {
  return interlock_without(rig, &Rig::feed_interlock);
}

Measured supervisors_half(Rig& rig, Operator&) {
  return interlock_without(rig, &Rig::feed_supervisors_half);
}

const Sample* first(const std::vector<Sample>& samples, bool (*is)(const Sample&)) {
  for (const Sample& sample : samples)
    if (is(sample)) return &sample;
  return nullptr;
}

Measured emergency_stop(Rig& rig, Operator& operator_) {
  const bool agreed =
      operator_.confirm(Act::PressEstopUnderVoltage,
                        "The stage will be put to 0.3 kV for 20 s. Press the emergency stop in that time.");
  if (!agreed) return {{kNotMeasured, kNotMeasured}, "was not pressed"};
  const Drive drive = rig.drive(kTestLevel_mV, 20 * kSecond, has_voltage);
  const bool released = operator_.confirm(Act::ReleaseEstop, "Release the emergency stop.");
  const Sample* const gone = first(drive.samples, [](const Sample& s) { return !has_voltage(s); });
  const Sample* const a =
      first(drive.samples, [](const Sample& s) { return s.has_contacts && !s.estop_a_closed; });
  const Sample* const b =
      first(drive.samples, [](const Sample& s) { return s.has_contacts && !s.estop_b_closed; });
  if (!released || gone == nullptr) return {{kNotMeasured, kNotMeasured}, drive.stopped_because};
  if (!gone->has_contacts && gone->command_mV == kTestLevel_mV)
    return {{0.0, 0.0}, "the contacts are not on this device: only the loss of voltage was measured"};
  if (a == nullptr || b == nullptr)
    return {{kNotMeasured, kNotMeasured},
            "no contact of the emergency stop opened, or only one " + drive.stopped_because};
  const double skew_ms = ms_between(*a, *b);
  return {{ms_between(skew_ms >= 0.0 ? *a : *b, *gone), std::abs(skew_ms)}, {}};
}

std::vector<Step> listed() {
  const std::vector<Limit> half_limits{
      {"voltage before", "kV", 0.28, 0.32, "without voltage the interlock is not tested"},
      {"time until it is gone", "ms", 3.0, 23.0,
       "20 ms after the last pulse, a tick before and after, one of jitter"}};
  return {
      {"wiring at 0 V",
       "Patient and needle are away. The amplifier's high voltage is OFF. Laser, monitors, command and "
       "interlock are "
       "connected as docs/how-to/commission-a-stage.md shows. The plate rests.",
       {{"laser readings that are valid", "1", 0.999, 1.0, "three missing in a row end every motion (R-20)"},
        {"scatter of the laser", "mm", 0.0, 0.03, "depth is promised to 0.1 mm: a third of it"},
        {"fewest different laser codes in 20 ms", "1", 2.0, 20.0,
         "a code that never changes is a frozen sensor (R-19)"},
        {"voltage monitor at 0 V", "kV", -0.02, 0.02, "a fifth of what counts as zero volts"},
        {"scatter of the voltage monitor", "kV", 0.0, 0.02,
         "five of it are still below what counts as voltage"},
        {"current monitor at 0 V", "mA", -0.25, 0.25, "a quarter of what counts as an arc (R-07)"}},
       wiring},
      {"laser zero and direction",
       "The plate rests on its stop, as when the needle waits. A gauge block of 2 to 8 mm is at hand.",
       {{"depth at rest", "mm", -0.1, 0.1, "depth is promised to 0.1 mm; correct zero_V by this figure"},
        {"gauge block", "mm", 2.0, 8.0, "less shows little of the scale, more leaves the stroke"},
        {"laser minus block", "mm", -0.1, 0.1, "depth is promised to 0.1 mm; a wrong sign shows here too"},
        {"depth after the block", "mm", -0.5, 0.5, "friction may hold it; 1 mm counts as withdrawn"}},
       laser},
      {"loop rate",
       "Nothing is moved; no other heavy program runs on this computer. Takes 10 s.",
       {{"ticks that missed their millisecond", "1", 0.0, 0.001, "the control loop is one of 1 kHz"},
        {"most of them within 100 ms", "1", 0.0, 2.0, "the third ends every motion (R-24)"},
        {"longest time between two readings", "ms", 0.0, 5.0, "more is a clock that jumped (R-05)"},
        {"work of a tick, 99 of 100", "us", 0.0, 800.0, "gate, bus and scheduler need the rest"}},
       loop_rate},
      {"monitor gain",
       "Keep your distance. Switch the amplifier's high voltage ON: the stage gets up to 0.5 kV, of both "
       "signs.",
       {{"gain of monitor over command", "1", 0.98, 1.02, "3 % apart ends every motion (R-08)"},
        {"offset", "kV", -0.02, 0.02, "a fifth of what counts as zero volts"},
        {"largest distance from the line", "kV", 0.0, 0.01, "monitor and command are one straight line"},
        {"largest current while the voltage stands", "mA", 0.0, 0.25,
         "leakage of a sound stack is far below"}},
       monitor_gain},
      {"interlock", "Both halves of the interlock are fed. The driver will stop its pulse at 0.3 kV.",
       half_limits, drivers_half},
      {"interlock, supervisor's half",
       "Both halves of the interlock are fed. The supervisor will stop its pulse at 0.3 kV.", half_limits,
       supervisors_half},
      {"emergency stop",
       "The emergency stop is released.",
       {{"from the first contact until the voltage is gone", "ms", 0.0, 10.0, "a C0 stop takes 10 ms"},
        {"between the two contacts", "ms", 0.0, 20.0, "more and they disagree (R-04)"}},
       emergency_stop},
  };
}

}  // namespace

const std::vector<Step>& all_steps() {
  static const std::vector<Step> steps = listed();
  return steps;
}

}  // namespace biopsy::commissioning
