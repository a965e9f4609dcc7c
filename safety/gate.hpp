// The only function that produces a drive voltage. Lowering |V| always passes; raising it needs a live
// permit.
//
// Without a live permit, with a clock that jumped or with not exactly one writer the gate puts out 0 V and
// disables HV in that tick (a permit lives 5 ms, so a dead supervisor costs <= 5 ms) and latches: it stays
// off until it has accepted a permit that disables HV, that is, until the supervisor has passed a disarmed
// state. Without a new request the voltage neither rises nor changes sign but follows the envelope down: a
// silent controller ends in a C1 ramp. The brake that locks the needle is on only under a permit that says
// so, and lets go wherever HV is disabled.
#pragma once

#include <cstdint>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

struct GateState;
struct GateResult;

// The only type that the actuator accepts. Made by the gate alone; off needs no permit.
class GatedVoltage {
 public:
  static constexpr GatedVoltage off() { return {0, false, false, false}; }
  constexpr std::int32_t mV() const { return mV_; }  // signed high voltage
  constexpr bool hv_enabled() const { return hv_enabled_; }
  constexpr bool brake_on() const { return brake_on_; }  // the needle is locked
  // The driver's half of the interlock gets its pulse. Not before the first permit, nor in Boot, where the
  // supervisor tests whether this half opens by itself.
  constexpr bool feeds_interlock() const { return feeds_interlock_; }

 private:
  constexpr GatedVoltage(std::int32_t mV, bool hv_enabled, bool brake_on, bool feeds_interlock)
      : mV_(mV), hv_enabled_(hv_enabled), brake_on_(brake_on), feeds_interlock_(feeds_interlock) {}
  friend GateResult gate(const GateState&, const DriveRequest*, const Permit*, std::int64_t, std::int32_t);

  std::int32_t mV_;
  bool hv_enabled_;
  bool brake_on_;
  bool feeds_interlock_;
};

// Default-constructed at each start of the driver, after it wrote 0 V: bound to no session.
struct GateState {
  Permit permit;               // last honoured; seq 0 = none
  std::int64_t permit_us = 0;  // when it was honoured, on the gate's clock
  std::int64_t now_us = 0;     // of the last call
  std::uint32_t request_seq = 0;
  std::int32_t drive_mV = 0;  // put out last, signed
  bool enabled = false;
  bool brake_on = false;
  bool started = false;                        // the clock has been read once
  GateVerdict latched = GateVerdict::Granted;  // not Granted: off for this reason until a permit disables HV
};

struct GateResult {
  GateState state;
  GatedVoltage voltage = GatedVoltage::off();
  GateVerdict verdict = GateVerdict::Refused;
  std::uint32_t answer = 0, answered_seq = 0;  // for Measurement: answers the last honoured permit, 0 if none
};

// `request` and `permit`: newest received, null if none; one seen before counts as none (and as OldSequence
// where it is the permit's number that went back). `now_us`: driver's monotonic clock, called every tick.
// `writer_count`: writers of the permit and request topics, must be 1. A
// lower voltage is always granted at once. A permit is honoured if its session is bound, its epoch not older,
// its seq rising. A session is bound by the first "off" permit while the output is off and no permit is live;
// after that only a larger session, by the same rule.
GateResult gate(const GateState& state, const DriveRequest* request, const Permit* permit,
                std::int64_t now_us, std::int32_t writer_count);

}  // namespace biopsy::safety
