#include "drivers/digital_io/io_views.hpp"

#include <cstdlib>

#include "safety/types/thresholds.hpp"

namespace biopsy::digital_io {
namespace {

// A counter with one writer needs no read-modify-write.
void count_up(Word& counter) {
  counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

bool is_closed(const RelayReading& seen, std::int64_t now_ns) {
  return seen.output.closed && std::abs(now_ns - seen.ticked_ns) / 1'000 < safety::kInterlock_us;
}

}  // namespace

StageIo::StageIo(const std::filesystem::path& run_folder) : io_(run_folder, Owner::Stage) {
  write(safety::GatedVoltage::off());
}

void StageIo::write(const safety::GatedVoltage& voltage) {
  io_.block().stage.converter.store(packed(voltage.mV(), voltage.hv_enabled()), std::memory_order_release);
}

void StageIo::pulse() {
  count_up(io_.block().stage.pulses);
}

void StageIo::mark_panel_read(std::int64_t now_ns) {
  io_.block().stage.panel_read_ns.store(now_ns, std::memory_order_release);
}

SupervisorIo::SupervisorIo(const std::filesystem::path& run_folder) : io_(run_folder, Owner::Supervisor) {}

void SupervisorIo::pulse() {
  count_up(io_.block().supervisor.pulses);
}

PanelIo::PanelIo(const std::filesystem::path& run_folder) : io_(run_folder, Owner::Panel) {
  set(PanelLevels{});
}

void PanelIo::set(const PanelLevels& levels) {
  io_.block().panel.levels.store(packed(levels), std::memory_order_release);
}

InterlockIo::InterlockIo(const std::filesystem::path& run_folder) : io_(run_folder, Owner::Interlock) {}

void InterlockIo::write(const RelayOutput& output, std::int64_t now_ns) {
  InterlockOutputs& block = io_.block().interlock;
  if (voltage_mV(block.load.load(std::memory_order_relaxed)) != output.load_mV) {
    block.changed_ns.store(now_ns, std::memory_order_relaxed);
    if (output.load_mV == 0) block.zero_ns.store(now_ns, std::memory_order_relaxed);
  }
  block.ticked_ns.store(now_ns, std::memory_order_relaxed);
  block.load.store(packed(output.load_mV, output.closed), std::memory_order_release);
  count_up(block.ticks);
}

IoReader::IoReader(const std::filesystem::path& run_folder) : io_(run_folder, Owner::None) {}

ConverterOutput IoReader::converter() const {
  const std::uint64_t word = io_.block().stage.converter.load(std::memory_order_acquire);
  return {voltage_mV(word), flag(word)};
}

std::uint64_t IoReader::stage_pulses() const {
  return io_.block().stage.pulses.load(std::memory_order_acquire);
}

std::uint64_t IoReader::supervisor_pulses() const {
  return io_.block().supervisor.pulses.load(std::memory_order_acquire);
}

PanelReading IoReader::panel(std::int64_t now_ns) const {
  const std::int64_t read_ns = io_.block().stage.panel_read_ns.load(std::memory_order_acquire);
  if (read_ns == 0 || std::abs(now_ns - read_ns) / 1'000 >= safety::kPanelRead_us) return {};
  PanelReading reading{panel_levels(io_.block().panel.levels.load(std::memory_order_acquire)), true};
  // The relay that a process stands for has its contact in its own block.
  reading.levels.relay_closed = reading.levels.relay_closed || is_closed(relay(), now_ns);
  return reading;
}

RelayReading IoReader::relay() const {
  const InterlockOutputs& block = io_.block().interlock;
  RelayReading reading;
  const std::uint64_t load = block.load.load(std::memory_order_acquire);
  reading.output = {voltage_mV(load), flag(load)};
  reading.changed_ns = block.changed_ns.load(std::memory_order_relaxed);
  reading.zero_ns = block.zero_ns.load(std::memory_order_relaxed);
  reading.ticked_ns = block.ticked_ns.load(std::memory_order_relaxed);
  reading.ticks = block.ticks.load(std::memory_order_acquire);
  return reading;
}

bool IoReader::is_supplied(std::int64_t now_ns) const {
  return is_closed(relay(), now_ns) && converter().hv_enabled;
}

std::int32_t IoReader::load_voltage_seen_mV(std::int64_t now_ns) const {
  return is_supplied(now_ns) ? converter().mV : 0;
}

}  // namespace biopsy::digital_io
