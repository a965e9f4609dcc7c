// Whatever stands on the wire, decoding is total: only codes this build knows come out, and what comes out
// goes over the wire and back unchanged.
#include "robot/transport/codec.hpp"

#include <cstring>

#include "tests/verification/fuzz/target.hpp"

namespace {

using namespace biopsy;
using namespace biopsy::fuzz;

// The library's reader lets no boolean through that is neither, and ends every text.
void make_sound(bool& flag) {
  auto* byte = reinterpret_cast<unsigned char*>(&flag);
  *byte &= 1U;
}

template <class Wire>
void make_sound_fields(Wire& wire) {
  const auto both = [](bool& a, bool& b) { make_sound(a), make_sound(b); };
  if constexpr (requires { wire.laser_valid; }) both(wire.laser_valid, wire.hv_enabled);
  if constexpr (requires { wire.stage_reached; }) both(wire.stage_reached, wire.finished);
  if constexpr (requires { wire.hv_enable; }) make_sound(wire.hv_enable);
  if constexpr (requires { wire.image_allowed; })
    both(wire.stage_done, wire.image_allowed), make_sound(wire.image_disturbed);
  if constexpr (requires { wire.token; })
    both(wire.held, wire.finish), both(wire.acquiring, wire.arm), make_sound(wire.reset);
  if constexpr (requires { wire.accepted; }) make_sound(wire.accepted);
  if constexpr (requires { wire.ready; }) make_sound(wire.ready), wire.note[sizeof(wire.note) - 1] = '\0';
}

template <class Message>
void claim_known(const Message& m) {
  if constexpr (requires { m.mode; }) claim(m.mode <= Mode::Lock, "a mode that exists");
  if constexpr (requires { m.stop; }) claim(m.stop <= StopCategory::C0Off, "a stop that exists");
  if constexpr (requires { m.verdict; }) claim(m.verdict <= GateVerdict::Limited, "a verdict that exists");
  if constexpr (requires { m.process; }) claim(m.process <= Process::Person, "a process that exists");
  if constexpr (requires { m.note; }) claim(m.note.size() <= 120, "a note no longer than the wire's");
}

template <class Message, class Wire>
void there_and_back(Bytes bytes) {
  Wire wire, once, twice;
  for (Wire* each : {&wire, &once, &twice}) std::memset(each, 0, sizeof(Wire));
  std::memcpy(&wire, bytes.data(), std::min(bytes.size(), sizeof(Wire)));
  make_sound_fields(wire);
  Message message, again;
  transport::decode(wire, message);
  claim_known(message);
  transport::encode(message, once);
  transport::decode(once, again);
  transport::encode(again, twice);
  claim(std::memcmp(&once, &twice, sizeof(Wire)) == 0, "there and back is the same");
}

void plan_there_and_back(Bytes bytes) {
  biopsy_wire_SealedPlan wire;
  std::memset(&wire, 0, sizeof(wire));
  wire.bytes._length = wire.bytes._maximum = static_cast<std::uint32_t>(bytes.size());
  wire.bytes._buffer = const_cast<std::uint8_t*>(bytes.data());
  SealedPlan plan, again;
  transport::decode(wire, plan);
  transport::encode(plan, wire);
  transport::decode(wire, again);
  claim(plan.bytes == again.bytes && std::ranges::equal(plan.bytes, bytes), "a plan keeps its bytes");
}

}  // namespace

FUZZ(codec) {
  if (bytes.empty()) return;
  const Bytes rest = bytes.subspan(1);
  switch (bytes[0] % 10) {
    case 0:
      return there_and_back<Measurement, biopsy_wire_Measurement>(rest);
    case 1:
      return there_and_back<DriveRequest, biopsy_wire_DriveRequest>(rest);
    case 2:
      return there_and_back<Permit, biopsy_wire_Permit>(rest);
    case 3:
      return there_and_back<Decision, biopsy_wire_Decision>(rest);
    case 4:
      return there_and_back<OperatorAct, biopsy_wire_OperatorAct>(rest);
    case 5:
      return there_and_back<DepthVerdictNote, biopsy_wire_DepthVerdict>(rest);
    case 6:
      return there_and_back<LogHealth, biopsy_wire_LogHealth>(rest);
    case 7:
      return there_and_back<StageTruth, biopsy_wire_StageTruth>(rest);
    case 8:
      return there_and_back<Health, biopsy_wire_Health>(rest);
    default:
      return plan_there_and_back(rest);
  }
}
