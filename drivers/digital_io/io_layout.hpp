// Layout of the shared memory that simulates the digital I/O between processes: one file for each owner, so
// that only its user can write it where every process has a user of its own. A file is a header's page and a
// page of outputs. All zero: 0 V, HV off, relay open, keys off, E-stop contacts open.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace biopsy::digital_io {

using Word = std::atomic<std::uint64_t>;
using Nanoseconds = std::atomic<std::int64_t>;  // CLOCK_MONOTONIC, the same in every process of a machine
static_assert(Word::is_always_lock_free && Nanoseconds::is_always_lock_free,
              "a process that is killed would keep a lock");

inline constexpr std::size_t kPage = 4096;
inline constexpr std::uint64_t kMagic = 0x6c'79'73'70'6f'69'62'01;  // 01 "biopsyl", low byte first
inline constexpr std::uint32_t kVersion = 3;

enum class Owner : std::uint32_t { Stage, Supervisor, Interlock, Panel };

// Written before the file gets its name, never after.
struct alignas(kPage) Header {
  std::uint64_t magic = kMagic;
  std::uint32_t version = kVersion;
  Owner owner = Owner::Stage;
};

struct alignas(kPage) StageOutputs {
  static constexpr Owner kOwner = Owner::Stage;
  Word converter;  // ConverterOutput in one word: code and enable change together
  Word pulses;
  Nanoseconds panel_read_ns;  // when the device's driver last read the panel; 0: never
};

struct alignas(kPage) SupervisorOutputs {
  static constexpr Owner kOwner = Owner::Supervisor;
  Word pulses;
};

struct alignas(kPage) InterlockOutputs {
  static constexpr Owner kOwner = Owner::Interlock;
  Word load;  // RelayOutput in one word
  Nanoseconds changed_ns, zero_ns, ticked_ns;
  Word ticks;
};

struct alignas(kPage) PanelInputs {
  static constexpr Owner kOwner = Owner::Panel;
  Word levels;  // PanelLevels
};

inline constexpr std::size_t kFileSize = 2 * kPage;
static_assert(sizeof(Header) == kPage && sizeof(StageOutputs) == kPage &&
              sizeof(SupervisorOutputs) == kPage && sizeof(InterlockOutputs) == kPage &&
              sizeof(PanelInputs) == kPage);

// The converter's voltage and the amplifier's enable.
struct ConverterOutput {
  std::int32_t mV = 0;  // signed high voltage
  bool hv_enabled = false;
  bool operator==(const ConverterOutput&) const = default;
};

struct RelayOutput {
  std::int32_t load_mV = 0;  // on the stack, signed
  bool closed = false;
  bool operator==(const RelayOutput&) const = default;
};

// Keys, buttons and contacts on the device. Both E-stop contacts closed: not pressed.
struct PanelLevels {
  bool arm_key = false, reset_key = false;
  bool estop_a_closed = false, estop_b_closed = false;
  bool bench_key = false;     // confirmed: no patient and no needle at the stage
  bool relay_closed = false;  // feedback contact of the interlock
  bool relay_wired = false;   // the device has that contact: no process stands for the relay
  bool operator==(const PanelLevels&) const = default;
};

// Of the panel as the device's driver read it; all open where it is not `read`.
struct PanelReading {
  PanelLevels levels;
  bool read = false;
  std::int64_t age_us = -1;  // since it was read last, whether `read` or not; -1: never
};

// A voltage in the low half of a word, a flag above it.
constexpr std::uint64_t packed(std::int32_t mV, bool flag) {
  return static_cast<std::uint32_t>(mV) | std::uint64_t{flag} << 32;
}
constexpr std::int32_t voltage_mV(std::uint64_t word) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(word));
}
constexpr bool flag(std::uint64_t word) {
  return (word >> 32 & 1) != 0;
}

constexpr std::uint64_t packed(const PanelLevels& panel) {
  return std::uint64_t{panel.arm_key} | std::uint64_t{panel.reset_key} << 1 |
         std::uint64_t{panel.estop_a_closed} << 2 | std::uint64_t{panel.estop_b_closed} << 3 |
         std::uint64_t{panel.bench_key} << 4 | std::uint64_t{panel.relay_closed} << 5 |
         std::uint64_t{panel.relay_wired} << 6;
}
constexpr PanelLevels panel_levels(std::uint64_t word) {
  const auto level = [word](int wire) { return (word >> wire & 1) != 0; };
  return {level(0), level(1), level(2), level(3), level(4), level(5), level(6)};
}

}  // namespace biopsy::digital_io
