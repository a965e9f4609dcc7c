// What must hold in every step of the gate.
#pragma once

#include <array>
#include <cstdint>

#include "tests/verification/model_checking/gate/gate_space.hpp"
#include "tests/verification/model_checking/supervisor/invariants.hpp"

namespace biopsy::model_checking {

struct GateStep {
  const safety::GateState& before;
  const GateInput& input;
  std::int64_t now_us;
  const safety::GateState& after;
  std::int32_t mV;
  bool hv_enabled;
  bool brake_on;
  GateVerdict verdict;

  std::int64_t was() const { return before.drive_mV < 0 ? -std::int64_t{before.drive_mV} : before.drive_mV; }
  std::int64_t is() const { return mV < 0 ? -std::int64_t{mV} : mV; }
  bool rises() const { return is() > was(); }
  bool is_off() const { return mV == 0 && !hv_enabled && !brake_on; }
  bool is_clock_sound() const { return !before.started || (input.dt_us > 0 && input.dt_us <= 5'000); }
  bool is_request_new() const { return input.request && input.request->seq != before.request_seq; }
  // The permit in force, on the gate's clock.
  bool is_live() const;
  // A permit arrived and was honoured in this tick.
  bool was_honoured() const;
};

struct GateInvariant {
  const char* name;
  const char* sentence;
  Finding (*check)(const GateStep&);
};

inline constexpr std::size_t kGateInvariants = 17;
extern const std::array<GateInvariant, kGateInvariants> kGateInvariantTable;

}  // namespace biopsy::model_checking
