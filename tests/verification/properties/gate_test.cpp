// The gate from any memory and any permit; and what making a permit worse does to it.
#include "safety/gate.hpp"

#include "safety/challenge.hpp"
#include "safety/types/limits.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/verification/fuzz/safety_values.hpp"
#include "tests/verification/properties/property.hpp"

namespace biopsy::properties {
namespace {

using safety::GateResult;
using safety::GateState;

std::int64_t magnitude(std::int32_t mV) {
  return mV < 0 ? -std::int64_t{mV} : mV;
}

// A gate that drives: bound, alive, at some voltage, under a permit with some envelope and slew.
struct Driving {
  GateState state;
  Permit permit;
  DriveRequest request;
  std::int64_t now_us = 0;
  GateResult tick() const { return safety::gate(state, &request, &permit, now_us, 1); }
};

Driving driving() {
  const auto up_to = [](std::int32_t most) { return *rc::gen::inRange<std::int32_t>(0, most + 1); };
  Driving d;
  d.now_us = *rc::gen::inRange<std::int64_t>(10'000, 1'000'000'000);
  d.permit = {.session = 3, .epoch = 2, .seq = 50, .ttl_us = limits::kPermitTtl_us, .mode = Mode::Active};
  d.permit.stop = StopCategory::None;
  d.permit.hv_enable = true;
  d.permit.v_max_mV = up_to(9'000'000);
  d.permit.slew_up_mV_per_tick = up_to(500'000);
  d.state.permit = d.permit;
  d.state.permit.seq = 49;
  d.state.permit_us = d.state.now_us = d.now_us - 1'000;
  d.state.started = d.state.enabled = true;
  d.state.request_seq = 8;
  d.state.drive_mV = up_to(limits::kDriveMax_mV) * *rc::gen::element(-1, 1);
  d.request.seq = 9;
  d.request.wanted_mV = up_to(10'000'000) * *rc::gen::element(-1, 1);
  return d;
}

RC_GTEST_PROP(Gate, KeepsTheHardLimitsFromAnyMemoryUnderAnyPermit, ()) {
  verifies("R-35", "R-47");
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  GateState state;
  Permit permit;
  DriveRequest request;
  fuzz::fill(feed, state), fuzz::fill(feed, permit), fuzz::fill(feed, request);
  const auto now_us = feed.any<std::int64_t>();
  const GateResult result = safety::gate(state, &request, &permit, now_us, *rc::gen::element(1, 1, 0, 2));
  RC_ASSERT(magnitude(result.voltage.mV()) <= limits::kDriveMax_mV);
  RC_ASSERT(result.voltage.hv_enabled() || result.voltage.mV() == 0);
  RC_ASSERT(magnitude(result.voltage.mV()) - magnitude(state.drive_mV) <= limits::kSlewUpMax_mV_per_tick);
}

RC_GTEST_PROP(Gate, LetsEveryLoweringPassWhateverBecameOfThePermit, ()) {
  verifies("R-34");
  Driving d = driving();
  d.request.wanted_mV =
      *rc::gen::inRange<std::int32_t>(0, static_cast<std::int32_t>(magnitude(d.state.drive_mV)) + 1);
  const auto bytes = any_bytes();
  fuzz::Feed feed(bytes);
  if (*rc::gen::arbitrary<bool>()) fuzz::fill(feed, d.permit);
  RC_ASSERT(magnitude(d.tick().voltage.mV()) <= d.request.wanted_mV);
  RC_ASSERT(magnitude(safety::gate(d.state, &d.request, nullptr, d.now_us, 1).voltage.mV()) <=
            d.request.wanted_mV);
}

RC_GTEST_PROP(Gate, GivesWhatIsAskedAsFarAsEnvelopeAndSlewGo, ()) {
  verifies("R-34", "R-35");
  const Driving d = driving();
  const std::int64_t envelope = std::min(d.permit.v_max_mV, limits::kDriveMax_mV);
  const std::int64_t reach =
      magnitude(d.state.drive_mV) + std::min(d.permit.slew_up_mV_per_tick, limits::kSlewUpMax_mV_per_tick);
  const GateResult result = d.tick();
  RC_ASSERT(magnitude(result.voltage.mV()) == std::min({magnitude(d.request.wanted_mV), envelope, reach}));
  RC_ASSERT((result.verdict == GateVerdict::Granted) == (result.voltage.mV() == d.request.wanted_mV));
}

RC_GTEST_PROP(Gate, NeverGivesMoreForAWorsePermit, ()) {
  verifies("R-48");
  const Driving d = driving();
  Driving worse = d;
  switch (*rc::gen::inRange(0, 7)) {
    case 0:
      worse.permit.v_max_mV -= *rc::gen::inRange(0, 9'000'000);
      break;
    case 1:
      worse.permit.slew_up_mV_per_tick -= *rc::gen::inRange(0, 500'000);
      break;
    case 2:
      worse.permit.stop = *rc::gen::element(StopCategory::C2Hold, StopCategory::C1Ramp, StopCategory::C0Off);
      break;
    case 3:
      worse.permit.mode = static_cast<Mode>(*rc::gen::arbitrary<std::uint8_t>());
      break;
    case 4:
      worse.permit.hv_enable = false;
      break;
    case 5:
      worse.permit.ttl_us = *rc::gen::arbitrary<std::int32_t>();
      break;
    default:
      worse.permit.seq = *rc::gen::inRange<std::uint32_t>(0, 50);
      break;
  }
  RC_ASSERT(magnitude(worse.tick().voltage.mV()) <= magnitude(d.tick().voltage.mV()) ||
            magnitude(worse.tick().voltage.mV()) <= magnitude(d.state.drive_mV));
}

RC_GTEST_PROP(Gate, AnswersWithTheVoltageItPutOut, ()) {
  verifies("R-10");
  Driving d = driving();
  d.permit.challenge = *rc::gen::arbitrary<std::uint32_t>();
  const GateResult result = d.tick();
  RC_ASSERT(result.answered_seq == d.permit.seq);
  RC_ASSERT(result.answer ==
            safety::answer_to(d.permit.challenge, result.voltage.mV(), Mode::Active, d.permit.seq));
}

}  // namespace
}  // namespace biopsy::properties
