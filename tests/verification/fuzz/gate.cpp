// The gate over any run of permits, requests, clocks and writers, from any memory: the output keeps the hard
// limits, and rises only under a permit that is honoured, alive and says so.
#include "safety/gate.hpp"

#include "tests/verification/fuzz/safety_values.hpp"

namespace {

using namespace biopsy;
using namespace biopsy::fuzz;

std::int64_t magnitude(std::int32_t mV) {
  return mV < 0 ? -std::int64_t{mV} : mV;
}

void claim_gate_sound(const safety::GateState& before, const safety::GateResult& result, bool asked,
                      std::int32_t writers) {
  const std::int64_t was = magnitude(before.drive_mV), is = magnitude(result.voltage.mV());
  claim(is <= limits::kDriveMax_mV, "never above the hard limit");
  claim(result.voltage.hv_enabled() || is == 0, "no voltage without the enable");
  claim(result.state.latched == GateVerdict::Granted || is == 0, "latched means off");
  claim(writers == 1 || !result.voltage.hv_enabled(), "not exactly one writer means off");
  if (is <= was) return;
  const Permit& permit = result.state.permit;
  claim(asked, "no rise unless asked");
  claim(permit.hv_enable && permit.mode == Mode::Active && permit.stop == StopCategory::None,
        "no rise without leave");
  claim(result.state.now_us - result.state.permit_us < limits::kPermitTtl_us, "no rise under a dead permit");
  claim(is <= permit.v_max_mV && is - was <= permit.slew_up_mV_per_tick, "no rise beyond the permit");
  claim(is - was <= limits::kSlewUpMax_mV_per_tick, "no rise steeper than the hard limit");
}

}  // namespace

FUZZ(gate) {
  Feed feed(bytes);
  safety::GateState state;
  if (feed.any<bool>()) fill(feed, state);
  Permit permit;
  permit.session = 1;
  permit.ttl_us = limits::kPermitTtl_us;
  DriveRequest request;
  std::int64_t now_us = 0;
  while (!feed.empty()) {
    const auto what = feed.any<std::uint8_t>();
    ++permit.seq, ++request.seq;
    now_us = static_cast<std::int64_t>(static_cast<std::uint64_t>(now_us) + 1'000);
    std::int32_t writers = 1;
    if (what & 1) permit.hv_enable = !permit.hv_enable;
    if (what & 2) permit.mode = Mode::Active, permit.stop = StopCategory::None;
    if (what & 4) feed.fill(permit.v_max_mV, permit.slew_up_mV_per_tick);
    if (what & 8) feed.fill(request.wanted_mV);
    if (what & 16) fill(feed, permit);
    if (what & 32) feed.fill(writers, request.seq, now_us);
    const bool asked = (what & 64) == 0;
    const safety::GateResult result =
        safety::gate(state, asked ? &request : nullptr, what & 128 ? nullptr : &permit, now_us, writers);
    claim_gate_sound(state, result, asked, writers);
    state = result.state;
  }
}
