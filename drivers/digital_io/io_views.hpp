// The shared digital I/O as each process sees it: a process writes its own file only. After construction
// nothing here allocates, locks or makes a system call. Constructors throw ConfigError, see IoFile.
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
  // Sets 0 V: the value that an earlier process left is not trusted.
  explicit StageIo(const std::filesystem::path& folder);

  void write(const safety::GatedVoltage& voltage);
  void pulse();                               // once in every tick that went well
  void mark_panel_read(std::int64_t now_ns);  // its levels are those of `now_ns` (CLOCK_MONOTONIC)

 private:
  OwnOutputs<StageOutputs> out_;
};

class SupervisorIo final : public drivers::PulseOutput {
 public:
  explicit SupervisorIo(const std::filesystem::path& folder);

  void pulse() override;  // in ticks whose SupervisorOutput::interlock_pulse is set

 private:
  OwnOutputs<SupervisorOutputs> out_;
};

class PanelIo {
 public:
  // Starts with no key turned and the E-stop pressed.
  explicit PanelIo(const std::filesystem::path& folder);

  void set(const PanelLevels& levels);

 private:
  OwnOutputs<PanelInputs> out_;
};

class InterlockIo {
 public:
  explicit InterlockIo(const std::filesystem::path& folder);

  // One tick of the relay at `now_ns` (CLOCK_MONOTONIC). Times are written before the load they belong to: a
  // reader of a load of 0 also reads when it became 0.
  void write(const RelayOutput& output, std::int64_t now_ns);

 private:
  OwnOutputs<InterlockOutputs> out_;
};

// State of the relay, as its process wrote it.
struct RelayReading {
  RelayOutput output;           // load_mV as it was in the relay's last tick
  std::int64_t changed_ns = 0;  // when load_mV last changed
  std::int64_t zero_ns = 0;     // when load_mV last became 0; 0 = never
  std::int64_t ticked_ns = 0;   // when it ticked last
  std::uint64_t ticks = 0;      // over all starts of the interlock process
};

// Reads all, writes nothing.
class IoReader {
 public:
  explicit IoReader(const std::filesystem::path& folder);

  ConverterOutput converter() const;
  std::uint64_t stage_pulses() const;
  std::uint64_t supervisor_pulses() const;
  // As the device's driver read it at most kPanelRead_us before `now_ns`, else unread; with the feedback of
  // the relay.
  PanelReading panel(std::int64_t now_ns) const;
  RelayReading relay() const;

  // Whether amplifier and brake are supplied at `now_ns`: the relay is closed and HV enabled. A relay whose
  // last tick is not within kInterlock_us of `now_ns` (on either side: it may have ticked since) counts as
  // open, as a real one does that loses its supply.
  bool is_supplied(std::int64_t now_ns) const;
  // The voltage on the stack then: the converter's present value, or 0.
  std::int32_t load_voltage_seen_mV(std::int64_t now_ns) const;

 private:
  SeenOutputs<StageOutputs> stage_;
  SeenOutputs<SupervisorOutputs> supervisor_;
  SeenOutputs<InterlockOutputs> interlock_;
  SeenOutputs<PanelInputs> panel_;
};

}  // namespace biopsy::digital_io
