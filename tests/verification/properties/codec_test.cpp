// Every message of the bus: any values go over the wire and come back, field by field.
#include "robot/transport/codec.hpp"

#include <tuple>

#include "tests/verification/fuzz/target.hpp"
#include "tests/verification/properties/property.hpp"

namespace biopsy::properties {
namespace {

auto fields(auto& m) {
  using Message = std::remove_cvref_t<decltype(m)>;
  if constexpr (std::is_same_v<Message, Measurement>)
    return std::tie(m.seq, m.time_us, m.depth_um, m.laser_code, m.laser_valid, m.monitor_mV, m.current_nA,
                    m.command_mV, m.hv_enabled, m.answer, m.answered_seq, m.verdict, m.config_tag);
  else if constexpr (std::is_same_v<Message, DriveRequest>)
    return std::tie(m.seq, m.wanted_mV, m.stage, m.stage_reached, m.finished, m.overruns, m.measured_seq,
                    m.setpoint_um, m.plan_tag, m.config_tag);
  else if constexpr (std::is_same_v<Message, Permit>)
    return std::tie(m.session, m.epoch, m.seq, m.issued_us, m.ttl_us, m.mode, m.stop, m.hv_enable, m.v_max_mV,
                    m.slew_up_mV_per_tick, m.slew_down_mV_per_tick, m.depth_max_um, m.plan_tag, m.config_tag,
                    m.challenge);
  else if constexpr (std::is_same_v<Message, Decision>)
    return std::tie(m.seq, m.time_us, m.at_ns, m.session, m.epoch, m.mode, m.stop, m.event, m.worst, m.reason,
                    m.refusal, m.stage, m.stage_done, m.image_allowed, m.image_disturbed);
  else if constexpr (std::is_same_v<Message, OperatorAct>)
    return std::tie(m.seq, m.token, m.held, m.stop, m.finish, m.acquiring, m.arm, m.reset,
                    m.patient_motion_um);
  else if constexpr (std::is_same_v<Message, DepthVerdictNote>)
    return std::tie(m.seq, m.plan_tag, m.stage, m.accepted);
  else if constexpr (std::is_same_v<Message, LogHealth>)
    return std::tie(m.seq, m.backlog_ms, m.records);
  else if constexpr (std::is_same_v<Message, StageTruth>)
    return std::tie(m.seq, m.tip_nm, m.plate_b_nm, m.layers_entered);
  else
    return std::tie(m.process, m.seq, m.ready, m.config_tag, m.plan_tag, m.overruns, m.late_p50_us,
                    m.late_p99_us, m.late_max_us, m.refused);
}

// Codes that exist; any other is turned into the least (tests/transport).
void keep_known(Mode& mode) {
  mode = static_cast<Mode>(static_cast<int>(mode) % 9);
}
void keep_known(StopCategory& stop) {
  stop = static_cast<StopCategory>(static_cast<int>(stop) % 4);
}
void keep_known(GateVerdict& verdict) {
  verdict = static_cast<GateVerdict>(static_cast<int>(verdict) % 11);
}
void keep_known(Process& process) {
  process = static_cast<Process>(static_cast<int>(process) % 6);
}
template <class Number>
void keep_known(Number&) {}

template <class Message, class Wire>
void comes_back() {
  const auto bytes = any_bytes(200);
  fuzz::Feed feed(bytes);
  Message sent, back;
  std::apply([&](auto&... field) { (feed.fill(field), ...), (keep_known(field), ...); }, fields(sent));
  Wire wire{};
  transport::encode(sent, wire);
  transport::decode(wire, back);
  RC_ASSERT(fields(back) == fields(sent));
}

RC_GTEST_PROP(Codec, BringsBackEveryFieldOfEveryMessage, ()) {
  comes_back<Measurement, biopsy_wire_Measurement>();
  comes_back<DriveRequest, biopsy_wire_DriveRequest>();
  comes_back<Permit, biopsy_wire_Permit>();
  comes_back<Decision, biopsy_wire_Decision>();
  comes_back<OperatorAct, biopsy_wire_OperatorAct>();
  comes_back<DepthVerdictNote, biopsy_wire_DepthVerdict>();
  comes_back<LogHealth, biopsy_wire_LogHealth>();
  comes_back<StageTruth, biopsy_wire_StageTruth>();
  comes_back<Health, biopsy_wire_Health>();
}

RC_GTEST_PROP(Codec, BringsBackAPlanByteByByte, ()) {
  SealedPlan sent, back;
  sent.seq = *rc::gen::arbitrary<std::uint32_t>();
  sent.bytes = any_bytes(*rc::gen::inRange<std::size_t>(0, 3'000));
  std::ranges::copy(any_bytes(32), sent.seal.begin());
  sent.confirmed_tag = {*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<std::uint64_t>()};
  biopsy_wire_SealedPlan wire{};
  transport::encode(sent, wire);
  transport::decode(wire, back);
  RC_ASSERT(back.seq == sent.seq && back.bytes == sent.bytes && back.seal == sent.seal &&
            back.confirmed_tag == sent.confirmed_tag);
}

}  // namespace
}  // namespace biopsy::properties
