#include "tests/verification/model_checking/gate/gate_space.hpp"

#include <algorithm>
#include <limits>

namespace biopsy::model_checking {
namespace {

constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kNow_us = 1'000'000, kEndOfLife_us = 5'000;
constexpr std::uint32_t kSession = 5, kEpoch = 10, kSeq = 1'000;
constexpr unsigned kAgeAt = 25, kLatchedAt = 28, kContentAt = 32, kFlagsAt = 37;

Permit content(Mode mode, StopCategory stop, bool enable, std::int32_t v_max_mV, std::int32_t slew,
               std::int32_t ttl_us = 5'000, bool brake = false) {
  Permit permit;
  permit.brake = brake;
  permit.mode = mode, permit.stop = stop, permit.hv_enable = enable;
  permit.v_max_mV = v_max_mV, permit.slew_up_mV_per_tick = slew, permit.ttl_us = ttl_us;
  return permit;
}

// What the supervisor sends in each mode, and what none should send but a broken one might.
std::vector<Permit> all_contents() {
  return {content(Mode::Safe, StopCategory::C0Off, false, 0, 0),
          content(Mode::Active, StopCategory::None, false, kMost, kMost),
          content(Mode::Armed, StopCategory::C2Hold, true, 0, 0),
          content(Mode::Active, StopCategory::None, true, 600'000, kMost),
          content(Mode::Active, StopCategory::None, true, kMost, kMost),
          content(Mode::Active, StopCategory::None, true, kMost, kMost, 2'000),
          content(Mode::Active, StopCategory::None, true, kMost, kMost, 60'000'000),
          content(Mode::Active, StopCategory::None, true, -1, -1),
          content(Mode::Hold, StopCategory::C2Hold, true, kMost, kMost),
          content(Mode::Hold, StopCategory::None, true, kMost, kMost),
          content(Mode::Active, StopCategory::C2Hold, true, kMost, kMost),
          content(Mode::Retract, StopCategory::C1Ramp, true, 600'000, 0),
          content(Mode::Hold, StopCategory::C2Hold, true, kMost, 0, 5'000, true),
          content(Mode::Active, StopCategory::None, true, 600'000, kMost, 5'000, true),
          content(Mode::Safe, StopCategory::C0Off, false, 0, 0, 5'000, true),
          content(Mode::Active, StopCategory::C0Off, true, kMost, kMost)};
}

bool is_same_content(const Permit& a, const Permit& b) {
  return a.mode == b.mode && a.stop == b.stop && a.hv_enable == b.hv_enable && a.v_max_mV == b.v_max_mV &&
         a.slew_up_mV_per_tick == b.slew_up_mV_per_tick && a.brake == b.brake &&
         (a.ttl_us == b.ttl_us || a.ttl_us == 0 || b.ttl_us == 0);
}

}  // namespace

GateSpace::GateSpace(bool quick) : contents_(all_contents()) {
  set_arrivals();
  asked_ = {{},
            {true, 0, -kMost},
            {true, 1, 0},
            {true, 1, 0, true},
            {true, 0, 0, true},
            {true, 1, kMost},
            {true, 1, std::numeric_limits<int>::min()}};
  if (!quick) asked_.push_back({true, -1, kMost}), asked_.push_back({true, 1, 600'000});
  beats_ = {{1'000, 1}, {5'000, 1}, {1'000, 0}, {1'000, 2}, {0, 1}, {-1'000, 1}, {5'001, 1}};
  if (!quick)
    for (const std::int64_t dt_us : {5'000, 0, -1'000, 5'001})
      for (const std::int32_t writers : {0, 2}) beats_.push_back({dt_us, writers});
}

void GateSpace::set_arrivals() {
  arrivals_ = {{Arrival::Kind::None}, {Arrival::Kind::Again}};
  for (std::size_t content = 0; content < contents_.size(); ++content) {
    for (const int epoch : {-1, 0, 1})
      for (const int seq : {-1, 1}) arrivals_.push_back({Arrival::Kind::New, 0, epoch, seq, content});
    for (const int session : {-1, 1})
      for (const int seq : {0, 1}) arrivals_.push_back({Arrival::Kind::New, session, 0, seq, content});
  }
}

std::uint32_t GateSpace::size() const {
  return static_cast<std::uint32_t>(arrivals_.size() * asked_.size() * beats_.size());
}

GateInput GateSpace::at(std::uint32_t index, const safety::GateState& state) const {
  GateInput input;
  const Beat& beat = beats_[index % beats_.size()];
  index /= static_cast<std::uint32_t>(beats_.size());
  const Asked& asked = asked_[index % asked_.size()];
  const Arrival& arrival = arrivals_[index / asked_.size()];
  input.dt_us = beat.dt_us;
  input.writers = beat.writers;
  if (asked.any) {
    input.request.emplace();
    input.request->seq = state.request_seq + asked.seq;
    input.request->wanted_mV = asked.wanted_mV;
    input.request->brake = asked.brake;
  }
  if (arrival.kind == Arrival::Kind::Again) input.permit = state.permit;
  if (arrival.kind != Arrival::Kind::New) return input;
  input.permit = contents_[arrival.content];
  const auto beside = [](std::uint32_t number, int by) { return by < 0 && number == 0 ? 0 : number + by; };
  input.permit->session = beside(state.permit.session, arrival.session);
  input.permit->epoch = beside(state.permit.epoch, arrival.epoch);
  input.permit->seq = beside(state.permit.seq, arrival.seq);
  return input;
}

std::size_t GateSpace::content_of(const Permit& permit) const {
  // A life of 0 (the gate's own stop) fits any life; the exact one is looked for first.
  const auto exact = std::ranges::find_if(
      contents_, [&](const Permit& c) { return is_same_content(c, permit) && c.ttl_us == permit.ttl_us; });
  const auto any =
      std::ranges::find_if(contents_, [&](const Permit& c) { return is_same_content(c, permit); });
  return static_cast<std::size_t>((exact != contents_.end() ? exact : any) - contents_.begin());
}

// voltage 25 | age 3 | latched 4 | content 5 | dead, bound, enabled, started, asked, brake
std::uint64_t GateSpace::key_of(const safety::GateState& state) const {
  const bool bound = state.permit.seq != 0, dead = state.permit.ttl_us == 0;
  const std::int64_t age_us = bound && !dead ? state.now_us - state.permit_us : kEndOfLife_us;
  const auto age = static_cast<std::uint64_t>(std::clamp<std::int64_t>(age_us, 0, kEndOfLife_us) / 1'000);
  const std::uint64_t flags = std::uint64_t{dead} | std::uint64_t{bound} << 1U |
                              std::uint64_t{state.enabled} << 2U | std::uint64_t{state.started} << 3U |
                              std::uint64_t{state.request_seq != 0} << 4U |
                              std::uint64_t{state.brake_on} << 5U;
  return static_cast<std::uint64_t>(state.drive_mV + 16'000'000) | age << kAgeAt |
         static_cast<std::uint64_t>(state.latched) << kLatchedAt |
         (bound ? content_of(state.permit) : 0) << kContentAt | flags << kFlagsAt;
}

safety::GateState GateSpace::state_of(std::uint64_t key) const {
  const auto flag = [key](unsigned bit) { return ((key >> (kFlagsAt + bit)) & 1U) != 0; };
  safety::GateState state;
  if (flag(1)) {
    state.permit = contents_[(key >> kContentAt) & 0x1FU];
    state.permit.session = kSession, state.permit.epoch = kEpoch, state.permit.seq = kSeq;
  }
  if (flag(0)) state.permit.ttl_us = 0;
  state.now_us = kNow_us;
  state.permit_us = kNow_us - static_cast<std::int64_t>((key >> kAgeAt) & 7U) * 1'000;
  state.drive_mV = static_cast<std::int32_t>(key & 0x1FF'FFFFU) - 16'000'000;
  state.enabled = flag(2);
  state.started = flag(3);
  state.request_seq = flag(4) ? kSeq : 0;
  state.brake_on = flag(5);
  state.latched = static_cast<GateVerdict>((key >> kLatchedAt) & 0xFU);
  return state;
}

}  // namespace biopsy::model_checking
