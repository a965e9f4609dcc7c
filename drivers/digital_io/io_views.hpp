// The lines as each process sees them: it can write its own and nothing else. Nothing here allocates, locks
// or calls the system after construction. Constructors throw ConfigError, see SharedIo.
#pragma once

#include <cstdint>
#include <filesystem>

#include "drivers/digital_io/shared_io.hpp"
#include "drivers/pulse_output.hpp"
#include "safety/gate.hpp"

namespace biopsy::digital_io {

// The converter, the amplifier's HV enable and the stage's pulse to the interlock.
class StageIo {
 public:
  // Puts 0 V out: what stands on a converter after a crash is not to be trusted.
  explicit StageIo(const std::filesystem::path& run_folder);

  void write(const safety::GatedVoltage& voltage);
  void pulse();  // once in every tick that went well

 private:
  SharedIo lines_;
};

class SupervisorIo final : public drivers::PulseOutput {
 public:
  explicit SupervisorIo(const std::filesystem::path& run_folder);

  void pulse() override;  // in ticks whose SupervisorOutput::interlock_pulse is set

 private:
  SharedIo lines_;
};

class PanelIo {
 public:
  // Starts with no key turned and the E-stop pressed.
  explicit PanelIo(const std::filesystem::path& run_folder);

  void set(const PanelLevels& levels);

 private:
  SharedIo lines_;
};

class InterlockIo {
 public:
  explicit InterlockIo(const std::filesystem::path& run_folder);

  // One tick of the relay at `now_ns` (CLOCK_MONOTONIC). Times are written before the load they date: who
  // sees a load of 0 also sees when it became 0.
  void write(const RelayOutput& output, std::int64_t now_ns);

 private:
  SharedIo lines_;
};

// What the interlock says of itself.
struct RelayReading {
  RelayOutput output;           // load_mV as it was in the relay's last tick
  std::int64_t changed_ns = 0;  // when load_mV last changed
  std::int64_t zero_ns = 0;     // when load_mV last became 0; 0 = never
  std::int64_t ticked_ns = 0;   // when it ticked last
  std::uint64_t ticks = 0;      // over all lives of the interlock process
};

// Reads all, writes nothing.
class IoReader {
 public:
  explicit IoReader(const std::filesystem::path& run_folder);

  ConverterOutput converter() const;
  std::uint64_t stage_pulses() const;
  std::uint64_t supervisor_pulses() const;
  PanelLevels panel() const;
  RelayReading relay() const;

  // The voltage on the stack at `now_ns`: the converter's while the relay is closed and HV enabled, else 0.
  // A real relay that loses its supply falls open; a process that is killed or stopped leaves its last word
  // in memory. So a relay whose last tick is not within kInterlock_us of now counts as open. (It may have
  // ticked a little after `now_ns` was read, hence on either side.) Takes the converter as it is now, not as
  // the relay last saw it: copper does not wait for a tick.
  std::int32_t load_voltage_seen_mV(std::int64_t now_ns) const;

 private:
  SharedIo lines_;
};

}  // namespace biopsy::digital_io
