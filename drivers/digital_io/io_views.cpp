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

StageIo::StageIo(const std::filesystem::path& folder) : out_(folder) {
  write(safety::GatedVoltage::off());
}

void StageIo::write(const safety::GatedVoltage& voltage) {
  out_->converter.store(packed(voltage.mV(), voltage.hv_enabled()), std::memory_order_release);
}

void StageIo::pulse() {
  count_up(out_->pulses);
}

void StageIo::mark_panel_read(std::int64_t now_ns) {
  out_->panel_read_ns.store(now_ns, std::memory_order_release);
}

SupervisorIo::SupervisorIo(const std::filesystem::path& folder) : out_(folder) {}

void SupervisorIo::pulse() {
  count_up(out_->pulses);
}

PanelIo::PanelIo(const std::filesystem::path& folder) : out_(folder) {
  set(PanelLevels{});
}

void PanelIo::set(const PanelLevels& levels) {
  out_->levels.store(packed(levels), std::memory_order_release);
}

InterlockIo::InterlockIo(const std::filesystem::path& folder) : out_(folder) {}

void InterlockIo::write(const RelayOutput& output, std::int64_t now_ns) {
  if (voltage_mV(out_->load.load(std::memory_order_relaxed)) != output.load_mV) {
    out_->changed_ns.store(now_ns, std::memory_order_relaxed);
    if (output.load_mV == 0) out_->zero_ns.store(now_ns, std::memory_order_relaxed);
  }
  out_->ticked_ns.store(now_ns, std::memory_order_relaxed);
  out_->load.store(packed(output.load_mV, output.closed), std::memory_order_release);
  count_up(out_->ticks);
}

IoReader::IoReader(const std::filesystem::path& folder)
    : stage_(folder), supervisor_(folder), interlock_(folder), panel_(folder) {}

ConverterOutput IoReader::converter() const {
  const std::uint64_t word = stage_->converter.load(std::memory_order_acquire);
  return {voltage_mV(word), flag(word)};
}

std::uint64_t IoReader::stage_pulses() const {
  return stage_->pulses.load(std::memory_order_acquire);
}

std::uint64_t IoReader::supervisor_pulses() const {
  return supervisor_->pulses.load(std::memory_order_acquire);
}

PanelReading IoReader::panel(std::int64_t now_ns) const {
  const std::int64_t read_ns = stage_->panel_read_ns.load(std::memory_order_acquire);
  if (read_ns == 0) return {};
  const std::int64_t age_us = std::abs(now_ns - read_ns) / 1'000;
  if (age_us >= safety::kPanelRead_us) return {.levels = {}, .read = false, .age_us = age_us};
  PanelReading reading{panel_levels(panel_->levels.load(std::memory_order_acquire)), true, age_us};
  // The relay that a process stands for has its contact in that process's file.
  if (!reading.levels.relay_wired) reading.levels.relay_closed = is_closed(relay(), now_ns);
  return reading;
}

RelayReading IoReader::relay() const {
  RelayReading reading;
  const std::uint64_t load = interlock_->load.load(std::memory_order_acquire);
  reading.output = {voltage_mV(load), flag(load)};
  reading.changed_ns = interlock_->changed_ns.load(std::memory_order_relaxed);
  reading.zero_ns = interlock_->zero_ns.load(std::memory_order_relaxed);
  reading.ticked_ns = interlock_->ticked_ns.load(std::memory_order_relaxed);
  reading.ticks = interlock_->ticks.load(std::memory_order_acquire);
  return reading;
}

bool IoReader::is_supplied(std::int64_t now_ns) const {
  return is_closed(relay(), now_ns) && converter().hv_enabled;
}

std::int32_t IoReader::load_voltage_seen_mV(std::int64_t now_ns) const {
  return is_supplied(now_ns) ? converter().mV : 0;
}

}  // namespace biopsy::digital_io
