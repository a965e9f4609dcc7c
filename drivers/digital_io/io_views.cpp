#include "drivers/digital_io/io_views.hpp"

#include <cstdlib>

#include "safety/types/thresholds.hpp"

namespace biopsy::lines {
namespace {

// A counter with one writer needs no read-modify-write.
void count_up(Word& counter) {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

}  // namespace

StageLines::StageLines(const std::filesystem::path& run_folder) : lines_(run_folder, Owner::Stage) {
  write(safety::GatedVoltage::off());
}

void StageLines::write(const safety::GatedVoltage& voltage) {
  lines_.wires().stage.converter.store(packed(voltage.mV(), voltage.hv_enabled()), std::memory_order_release);
}

void StageLines::pulse() {
  count_up(lines_.wires().stage.pulses);
}

SupervisorLines::SupervisorLines(const std::filesystem::path& run_folder)
    : lines_(run_folder, Owner::Supervisor) {}

void SupervisorLines::pulse() {
  count_up(lines_.wires().supervisor.pulses);
}

PanelLines::PanelLines(const std::filesystem::path& run_folder) : lines_(run_folder, Owner::Panel) {
  set(PanelLevels{});
}

void PanelLines::set(const PanelLevels& levels) {
  lines_.wires().panel.levels.store(packed(levels), std::memory_order_release);
}

InterlockLines::InterlockLines(const std::filesystem::path& run_folder)
    : lines_(run_folder, Owner::Interlock) {}

void InterlockLines::write(const RelayOutput& output, std::int64_t now_ns) {
  InterlockWires& wires = lines_.wires().interlock;
  if (voltage_mV(wires.load.load(std::memory_order_relaxed)) != output.load_mV) {
    wires.changed_ns.store(now_ns, std::memory_order_relaxed);
    if (output.load_mV == 0) wires.zero_ns.store(now_ns, std::memory_order_relaxed);
  }
  wires.ticked_ns.store(now_ns, std::memory_order_relaxed);
  wires.load.store(packed(output.load_mV, output.closed), std::memory_order_release);
  count_up(wires.ticks);
}

LinesReader::LinesReader(const std::filesystem::path& run_folder) : lines_(run_folder, Owner::Nobody) {}

ConverterOutput LinesReader::converter() const {
  const std::uint64_t word = lines_.wires().stage.converter.load(std::memory_order_acquire);
  return {voltage_mV(word), flag(word)};
}

std::uint64_t LinesReader::stage_pulses() const {
  return lines_.wires().stage.pulses.load(std::memory_order_acquire);
}

std::uint64_t LinesReader::supervisor_pulses() const {
  return lines_.wires().supervisor.pulses.load(std::memory_order_acquire);
}

PanelLevels LinesReader::panel() const {
  return panel_levels(lines_.wires().panel.levels.load(std::memory_order_acquire));
}

RelayReading LinesReader::relay() const {
  const InterlockWires& wires = lines_.wires().interlock;
  RelayReading reading;
  const std::uint64_t load = wires.load.load(std::memory_order_acquire);
  reading.output = {voltage_mV(load), flag(load)};
  reading.changed_ns = wires.changed_ns.load(std::memory_order_relaxed);
  reading.zero_ns = wires.zero_ns.load(std::memory_order_relaxed);
  reading.ticked_ns = wires.ticked_ns.load(std::memory_order_relaxed);
  reading.ticks = wires.ticks.load(std::memory_order_acquire);
  return reading;
}

std::int32_t LinesReader::load_voltage_seen_mV(std::int64_t now_ns) const {
  const RelayReading seen = relay();
  const bool alive = std::abs(now_ns - seen.ticked_ns) / 1'000 < safety::kInterlock_us;
  const ConverterOutput output = converter();
  return alive && seen.output.closed && output.hv_enabled ? output.mV : 0;
}

}  // namespace biopsy::lines
