#include "robot/bench/commissioning_operator.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <istream>
#include <ostream>

namespace biopsy::robot {

using commissioning::Act;

namespace {

constexpr double kLift_N = 0.56;  // 4 mm on the series spring of 140 N/m

}  // namespace

void TerminalOperator::notify(const std::string& what) {
  out_ << what << '\n' << std::flush;
}

bool TerminalOperator::confirm(Act, const std::string& what) {
  out_ << "  " << what << '\n';
  for (std::string line;;) {
    out_ << "  done? [y/n] " << std::flush;
    if (!std::getline(in_, line)) return false;
    if (line == "y" || line == "yes") return true;
    if (line == "n" || line == "no") return false;
  }
}

std::optional<double> TerminalOperator::enter_value(const std::string& what) {
  for (std::string line;;) {
    out_ << "  " << what << ": " << std::flush;
    if (!std::getline(in_, line)) return std::nullopt;
    try {
      std::size_t end = 0;
      const double value = std::stod(line, &end);
      if (end == line.size() && std::isfinite(value)) return value;
    } catch (const std::logic_error&) {  // no number, or out of range: asked again
    }
  }
}

SimulatedBench::SimulatedBench(const sim::PlantModel& model, std::uint64_t seed) : stage_(model, seed) {}

std::int32_t SimulatedBench::write(const safety::GatedVoltage& voltage) {
  const std::int64_t now_us = stage_.now_us();
  if (feeding_ && voltage.feeds_interlock()) interlock_ = safety::feed_from_driver(interlock_, now_us);
  if (voltage.mV() != 0 && press_at_ && *press_at_ > 0) --*press_at_;
  if (press_at_ && *press_at_ == 0) ++pressed_ticks_;
  const bool powered = safety::is_closed(interlock_, now_us) && pressed_ticks_ == 0;
  stage_.write(powered ? voltage : safety::GatedVoltage::off());
  return voltage.mV();
}

StageConnections SimulatedBench::connections() {
  return {.estop =
              [this] {
                return StageConnections::Contacts{pressed_ticks_ == 0, pressed_ticks_ <= kContactLag_ticks};
              },
          .feed_interlock = [this](bool feeding) { feeding_ = feeding; },
          .supervisor_pulse = &supervisors_half_};
}

bool SimulatedOperator::confirm(Act act, const std::string& what) {
  if (always_agrees_) terminal_.notify("  " + what);
  if (!always_agrees_ && !terminal_.confirm(act, what)) return false;
  switch (act) {
    case Act::Prepare:
      break;
    case Act::LayBlock:
      bench_.lift(kLift_N);
      break;
    case Act::RemoveBlock:
      bench_.lift(0.0);
      break;
    case Act::PressEstopUnderVoltage:
      bench_.press_estop_under_voltage();
      break;
    case Act::ReleaseEstop:
      bench_.release_estop();
      break;
  }
  return true;
}

std::optional<double> SimulatedOperator::enter_value(const std::string& what) {
  const double height_mm = std::round(bench_.true_depth_mm() * 100.0) / 100.0;
  terminal_.notify(fmt::format("  {}: {:.2f} (simulated)", what, height_mm));
  return height_mm;
}

}  // namespace biopsy::robot
