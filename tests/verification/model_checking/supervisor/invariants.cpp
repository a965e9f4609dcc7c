#include "tests/verification/model_checking/supervisor/invariants.hpp"

#include <algorithm>
#include <utility>

#include "safety/challenge.hpp"
#include "tests/verification/model_checking/supervisor/table_row.hpp"

namespace biopsy::model_checking {
namespace {

using safety::Event;
using safety::Hazard;
using safety::HazardSet;
using safety::Refusal;
using safety::SelfTest;

// From the safety concept.
constexpr std::int32_t kBoot_ms = 10'000, kArmed_ms = 30'000, kHold_ms = 10'000, kRetract_ms = 300;
constexpr std::int32_t kSilence_ms = 100, kPermitLife_us = 5'000;
constexpr std::int32_t kHighest_mV = 8'000'000, kSteepest_mV = 400'000;

const HazardSet kLocking = safety::locking_hazards();
const HazardSet kC0 = safety::hazards_with(StopCategory::C0Off);

constexpr bool hv_permitted(Mode mode) {
  return mode == Mode::Armed || mode == Mode::Active || mode == Mode::Hold || mode == Mode::Retract;
}
constexpr bool is_off(const Permit& permit) {
  return !permit.hv_enable && permit.v_max_mV == 0 && permit.slew_up_mV_per_tick == 0 && !permit.brake;
}
bool has_step(const Step& s, std::uint32_t step) {
  return step < std::min<std::uint32_t>(s.plan.step_count, safety::kMaxSteps);
}
std::int32_t step_depth_um(const Step& s) {
  return s.after.mode == Mode::Active && has_step(s, s.after.step) ? s.plan.steps[s.after.step].depth_max_um
                                                                   : 0;
}
// A new token, held.
bool is_press(const Step& s) {
  return s.input.motion.held && s.input.motion.token > s.before.token;
}
bool is_heartbeat(const Step& s) {
  return s.input.motion.held && s.input.motion.token != 0 && s.input.motion.token >= s.before.token;
}
bool was_followed(const Step& s) {
  return s.output.event == Event::Reset || s.output.event == Event::Arm || s.output.event == Event::Move;
}

}  // namespace

static constexpr std::array<Invariant, kInvariants> kTable{{
    // Stops
    {"c0-same-tick", "A C0 hazard or stop takes enable, voltage and rise away in the same tick.",
     [](const Step& s) {
       return Finding{s.stop == StopCategory::C0Off && hv_permitted(s.before.mode),
                      is_off(s.output.permit) && s.after.mode == Mode::Trip};
     }},
    {"c0-keeps-off", "Under a C0 hazard no permit enables the drive, whatever the mode.",
     [](const Step& s) {
       return Finding{(s.hazards & kC0) != 0, is_off(s.output.permit)};
     }},
    {"c1-ends-motion", "C1 leaves Active, Hold and Retract no way but down.",
     [](const Step& s) {
       const bool carries = s.before.mode == Mode::Active || s.before.mode == Mode::Hold;
       return Finding{s.stop == StopCategory::C1Ramp && carries, s.after.mode == Mode::Retract};
     }},
    {"c2-stops-the-rise", "C2 in Active ends in Hold or Retract in the same tick.",
     [](const Step& s) {
       return Finding{s.stop == StopCategory::C2Hold && s.before.mode == Mode::Active,
                      s.after.mode == Mode::Hold || s.after.mode == Mode::Retract};
     }},
    {"lockout", "A locking hazard locks Boot, Safe, Ready and Trip.",
     [](const Step& s) {
       const Mode mode = s.before.mode;
       const bool cold =
           mode == Mode::Boot || mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Trip;
       return Finding{cold && (s.hazards & kLocking) != 0, s.after.mode == Mode::Lock};
     }},
    {"lock-absorbs", "Nothing leaves Lock.",
     [](const Step& s) {
       return Finding{s.before.mode == Mode::Lock, s.after.mode == Mode::Lock};
     }},
    {"worst-is-named", "The hazard that is named is the worst one present.",
     [](const Step& s) {
       return Finding{true, s.output.worst == safety::worst_of(s.hazards)};
     }},
    {"reason-is-kept", "A change of mode names its worst hazard, and keeps it through the end of a ramp.",
     [](const Step& s) {
       const bool renamed = s.before.mode != s.after.mode && s.output.event != Event::VoltageGone;
       const Hazard reason = renamed ? safety::worst_of(s.hazards) : s.before.reason;
       return Finding{true, s.after.reason == reason && s.output.reason == reason};
     }},
    // Rising
    {"only-active-rises", "Only in Active may the voltage rise.",
     [](const Step& s) {
       return Finding{s.output.permit.slew_up_mV_per_tick > 0, s.after.mode == Mode::Active};
     }},
    {"rise-needs-health", "A rise needs every hazard absent and no stop asked for.",
     [](const Step& s) {
       return Finding{s.after.mode == Mode::Active, s.stop == StopCategory::None};
     }},
    {"active-entry", "Active is entered only from Armed or Hold.",
     [](const Step& s) {
       return Finding{s.enters(Mode::Active), s.before.mode == Mode::Armed || s.before.mode == Mode::Hold};
     }},
    {"press-once", "Motion begins only with a token never seen before, held.",
     [](const Step& s) {
       return Finding{s.enters(Mode::Active), is_press(s)};
     }},
    {"tokens-are-spent", "The largest token seen is remembered: none is accepted twice.",
     [](const Step& s) {
       return Finding{true, s.after.token == std::max(s.before.token, s.input.motion.token)};
     }},
    {"late-heartbeat", "A heartbeat of a spent token never restarts motion.",
     [](const Step& s) {
       return Finding{s.before.mode != Mode::Active && s.input.motion.token <= s.before.token,
                      s.after.mode != Mode::Active};
     }},
    {"release-stops", "Letting the button go, or pressing another, ends Active in that tick.",
     [](const Step& s) {
       const std::uint32_t sent = s.input.motion.token;
       const bool let_go = sent != 0 && sent == s.before.token && !s.input.motion.held;
       return Finding{s.before.mode == Mode::Active && (let_go || sent > s.before.token),
                      s.after.mode != Mode::Active};
     }},
    {"silence-is-counted", "Without a heartbeat the silence grows by a tick; only a heartbeat ends it.",
     [](const Step& s) {
       const std::int32_t silent = std::min(s.before.ms_since_held + 1, kSilence_ms);
       return Finding{s.after.mode == Mode::Active, s.after.ms_since_held == (is_heartbeat(s) ? 0 : silent)};
     }},
    {"silence-stops", "A console silent for 100 ms ends Active.",
     [](const Step& s) {
       return Finding{s.before.mode == Mode::Active && s.before.ms_since_held >= kSilence_ms,
                      s.after.mode != Mode::Active};
     }},
    // Steps
    {"step-ends-in-hold", "A step that is reached ends the rise.",
     [](const Step& s) {
       const bool reached = s.input.request.step_reached && s.input.request.step == s.before.step;
       return Finding{s.before.mode == Mode::Active && reached, s.after.mode != Mode::Active};
     }},
    {"reached-is-remembered", "A step counts as done after it was reached, and for no other reason.",
     [](const Step& s) {
       const bool reached = s.input.request.step_reached && s.input.request.step == s.before.step;
       const bool holds =
           (s.after.mode == Mode::Hold ? s.after.step_done == reached : !s.after.step_done || reached) &&
           (!s.after.step_done || s.after.arrived_seq == s.after.seq);
       const bool ends = s.after.mode == Mode::Retract || s.after.mode == Mode::Trip;
       return Finding{s.before.mode == Mode::Active && !ends, holds};
     }},
    {"depth-check", "Past a step that an image confirms only with a depth check of that very step and hold.",
     [](const Step& s) {
       const bool asks = s.before.mode == Mode::Hold && s.enters(Mode::Active) && s.before.step_done &&
                         s.plan.steps[s.before.step % safety::kMaxSteps].image_confirms;
       const bool of_this_hold = s.input.accepted_session == s.before.session &&
                                 s.input.accepted_since_seq >= s.before.arrived_seq &&
                                 s.input.accepted_since_seq <= s.before.seq;
       return Finding{asks, s.input.depth_accepted && s.input.accepted_step == s.before.step && of_this_hold};
     }},
    {"step-order", "Steps go up by one, from Hold at a step's end; arming begins at the first.",
     [](const Step& s) {
       if (s.enters(Mode::Armed)) return Finding{true, s.after.step == 0 && !s.after.step_done};
       const bool goes_on = s.before.mode == Mode::Hold && s.enters(Mode::Active) && s.before.step_done;
       return Finding{true, s.after.step == s.before.step + (goes_on ? 1 : 0)};
     }},
    {"plan-has-an-end", "No step beyond the plan's last is ever driven.",
     [](const Step& s) {
       return Finding{s.after.mode == Mode::Active && s.plan.step_count > 0,
                      has_step(s, s.after.step) && !s.after.step_done};
     }},
    {"finished-retracts", "A finished plan retracts.",
     [](const Step& s) {
       const bool carries = s.before.mode == Mode::Active || s.before.mode == Mode::Hold;
       return Finding{carries && s.input.request.finished && s.stop != StopCategory::C0Off,
                      s.after.mode == Mode::Retract};
     }},
    // Keys and network
    {"arming-is-local", "Arming needs an edge of the key on the device, in Ready, with nothing amiss.",
     [](const Step& s) {
       return Finding{s.enters(Mode::Armed),
                      s.before.mode == Mode::Ready && s.arm_edge() && s.stop == StopCategory::None};
     }},
    {"reset-is-local",
     "Trip leaves for Safe only on an edge of the reset key, at 0 V, needle home, nothing amiss.",
     [](const Step& s) {
       const bool may = s.reset_edge() && s.input.evidence.zero_volts && s.input.evidence.needle_home &&
                        s.stop == StopCategory::None;
       return Finding{s.before.mode == Mode::Trip && s.after.mode != Mode::Lock,
                      (s.after.mode == Mode::Safe) == may};
     }},
    {"keys-are-edges", "The position of each key is remembered, so that a key held down is no edge.",
     [](const Step& s) {
       return Finding{
           true, s.after.arm_was_down == s.input.local_arm && s.after.reset_was_down == s.input.local_reset};
     }},
    {"asked-and-answered", "A key or a press that is not followed gets a reason; one that is followed, none.",
     [](const Step& s) {
       const bool press = is_press(s) && s.before.mode != Mode::Active;
       const bool asked = s.arm_edge() || s.reset_edge() || press;
       return Finding{asked, (s.output.refusal == Refusal::None) == was_followed(s)};
     }},
    {"network-is-refused", "Arm and reset asked over the network are refused, with the reason.",
     [](const Step& s) {
       const Refusal reason = s.before.mode == Mode::Lock ? Refusal::Locked : Refusal::OnlyLocal;
       return Finding{(s.input.remote_arm || s.input.remote_reset) && !was_followed(s),
                      s.output.refusal == reason};
     }},
    {"silent-when-not-asked", "Where there is no request nothing is refused.",
     [](const Step& s) {
       const bool asked = s.arm_edge() || s.reset_edge() || s.input.remote_arm || s.input.remote_reset ||
                          (s.input.motion.held && s.input.motion.token != 0);
       return Finding{!asked, s.output.refusal == Refusal::None};
     }},
    // Zero volts
    {"cold-needs-zero", "Safe, Ready and Armed are entered and kept only at measured 0 V.",
     [](const Step& s) {
       const Mode mode = s.after.mode;
       return Finding{mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Armed,
                      s.input.evidence.zero_volts};
     }},
    {"voltage-trips", "Voltage where there must be none trips.",
     [](const Step& s) {
       const Mode mode = s.before.mode;
       const bool cold = mode == Mode::Safe || mode == Mode::Ready || mode == Mode::Armed;
       return Finding{cold && !s.input.evidence.zero_volts && (s.hazards & kLocking) == 0,
                      s.after.mode == Mode::Trip};
     }},
    {"boot-needs-self-test",
     "Boot ends in Safe only with its test passed and the interlock open; failed, it locks.",
     [](const Step& s) {
       const bool passed = s.input.self_test == SelfTest::Passed &&
                           (s.after.mode != Mode::Safe || s.input.evidence.interlock_opens);
       return Finding{s.before.mode == Mode::Boot &&
                          (s.after.mode != Mode::Boot || s.input.self_test == SelfTest::Failed),
                      s.after.mode == (passed ? s.after.mode : Mode::Lock)};
     }},
    {"ready-needs-health", "Ready is entered and kept only with every hazard absent and no stop asked for.",
     [](const Step& s) {
       const bool from = s.before.mode == Mode::Safe || s.before.mode == Mode::Ready;
       return Finding{from && (s.after.mode == Mode::Ready || s.after.mode == Mode::Armed),
                      s.stop == StopCategory::None};
     }},
    // Times
    {"timer-runs", "The time in a mode starts at 0, and each tick adds one, up to a bound.",
     [](const Step& s) {
       const std::int32_t most = s.before.mode == Mode::Hold ? kHold_ms - 1 : kArmed_ms;
       const std::int32_t ticks = std::min(s.before.ms_in_mode, most) + 1;
       return Finding{true, s.after.ms_in_mode == (s.after.mode == s.before.mode ? ticks : 0)};
     }},
    {"boot-ends", "Boot ends within 10 s.",
     [](const Step& s) {
       return Finding{s.stays(Mode::Boot), s.after.ms_in_mode < kBoot_ms};
     }},
    {"armed-ends", "Armed ends within 30 s.",
     [](const Step& s) {
       return Finding{s.stays(Mode::Armed), s.after.ms_in_mode < kArmed_ms};
     }},
    {"hold-ends",
     "Hold ends within 10 s, but for a locked needle that stays where it is while nothing is wrong.",
     [](const Step& s) {
       return Finding{s.stays(Mode::Hold) && (!s.input.evidence.still || s.stop != StopCategory::None),
                      s.after.ms_in_mode < kHold_ms};
     }},
    {"ready-needs-the-needle-back",
     "With a patient Ready is entered, kept and left for Armed with the needle back only.",
     [](const Step& s) {
       const bool patient = s.plan.bench_half_period_ticks <= 0;
       const bool ready = s.stays(Mode::Ready) || (s.enters(Mode::Ready) && s.before.mode == Mode::Safe);
       return Finding{patient && (ready || s.enters(Mode::Armed)), s.input.evidence.needle_back};
     }},
    {"image-waits", "No motion begins while an image is taken.",
     [](const Step& s) {
       return Finding{s.enters(Mode::Active), !s.input.acquiring};
     }},
    {"brake-takes-at-the-end",
     "The brake may take the needle at a step's end only, and keep it in Active and Hold.",
     [](const Step& s) {
       const bool held = s.after.mode == Mode::Active || s.after.mode == Mode::Hold;
       const bool arrived = s.after.mode == Mode::Hold && s.after.step_done;
       return Finding{true, s.output.permit.brake == ((arrived && s.input.measurement.brake_fitted) ||
                                                      (held && s.input.evidence.locked))};
     }},
    {"retract-ends", "Retract ends within 300 ms.",
     [](const Step& s) {
       return Finding{s.stays(Mode::Retract), s.after.ms_in_mode < kRetract_ms};
     }},
    {"counters-are-bounded", "Every counter stays in its bounds.",
     [](const Step& s) {
       const auto within = [](std::int32_t value, std::int32_t most) { return value >= 0 && value <= most; };
       return Finding{true, within(s.after.ms_in_mode, kArmed_ms + 1) &&
                                within(s.after.ms_since_held, kSilence_ms) &&
                                within(s.after.held_mV, kHighest_mV) && s.after.step < safety::kMaxSteps};
     }},
    // Envelope
    {"envelope-falls", "In Hold and Retract the envelope only falls.",
     [](const Step& s) {
       return Finding{s.after.mode == Mode::Hold || s.after.mode == Mode::Retract,
                      s.output.permit.v_max_mV <= envelope_mV(s.plan, s.before, s.input)};
     }},
    {"envelope-holds-what-is-there", "The envelope of a hold or ramp begins at the voltage that is there.",
     [](const Step& s) {
       const bool begins = s.enters(Mode::Hold) || s.enters(Mode::Retract);
       const std::int32_t there =
           std::clamp(s.input.evidence.drive_mV, 0, envelope_mV(s.plan, s.before, s.input));
       return Finding{begins, s.output.permit.v_max_mV == there};
     }},
    {"envelope-is-the-modes",
     "The envelope is the step's under the ceiling in Active, the ramp's in Retract: a line to 0 in 250 ms.",
     [](const Step& s) {
       return Finding{true, s.output.permit.v_max_mV == envelope_mV(s.plan, s.after, s.input)};
     }},
    {"limits", "No permit goes beyond 8 kV, 400 V a tick, or the depth of plan and step.",
     [](const Step& s) {
       const Permit& p = s.output.permit;
       return Finding{true, p.v_max_mV >= 0 && p.v_max_mV <= kHighest_mV && p.slew_up_mV_per_tick >= 0 &&
                                p.slew_up_mV_per_tick <= kSteepest_mV &&
                                p.depth_max_um <= s.plan.depth_max_um && p.depth_max_um <= step_depth_um(s)};
     }},
    // Permit
    {"enabled-iff-hot",
     "The drive is enabled exactly in Armed, Active, Hold and Retract, each with its stop.",
     [](const Step& s) {
       constexpr std::array kStop{StopCategory::C0Off,  StopCategory::C0Off, StopCategory::C0Off,
                                  StopCategory::C2Hold, StopCategory::None,  StopCategory::C2Hold,
                                  StopCategory::C1Ramp, StopCategory::C0Off, StopCategory::C0Off};
       const Permit& p = s.output.permit;
       return Finding{true, p.hv_enable == hv_permitted(s.after.mode) && (p.hv_enable || is_off(p)) &&
                                p.mode == s.after.mode &&
                                p.stop == kStop[static_cast<std::size_t>(s.after.mode)]};
     }},
    {"epoch", "A trip or lock raises the epoch by one, every hot -> Trip so; nothing else touches it.",
     [](const Step& s) {
       const bool raised = s.enters(Mode::Trip) || s.enters(Mode::Lock);
       return Finding{true, s.after.epoch == s.before.epoch + (raised ? 1 : 0) &&
                                s.output.permit.epoch == s.after.epoch};
     }},
    {"permit-is-bound",
     "Each permit has the next number, this session, plan and configuration, and lives 5 ms.",
     [](const Step& s) {
       const Permit& p = s.output.permit;
       return Finding{true, s.after.seq == s.before.seq + 1 && p.seq == s.after.seq &&
                                p.session == s.before.session && s.after.session == s.before.session &&
                                p.plan_tag == s.plan.plan_tag && p.config_tag == s.plan.config_tag &&
                                p.ttl_us == kPermitLife_us &&
                                p.challenge == safety::challenge_of(p.session, p.seq)};
     }},
    {"table", "The mode changes as the table of transitions has it, and only then.",
     [](const Step& s) {
       const bool changes = s.before.mode != s.after.mode;
       const bool known = is_table_row(s.before.mode, s.output.event, s.after.mode);
       return Finding{
           true, changes ? known && s.after.last_event == s.output.event : s.output.event == Event::None};
     }},
    {"interlock",
     "The interlock is fed in Boot, in Ready and wherever the drive may carry voltage, not elsewhere.",
     [](const Step& s) {
       const bool fed = s.after.mode == Mode::Boot || s.after.mode == Mode::Ready;
       return Finding{true, s.output.interlock_pulse == (fed || hv_permitted(s.after.mode))};
     }},
    {"images", "A scan may start unless the drive moves; one that saw the drive switch is flagged.",
     [](const Step& s) {
       const bool moves = s.after.mode == Mode::Active || s.after.mode == Mode::Retract;
       return Finding{true, s.output.image_allowed == !moves &&
                                s.output.image_disturbed == s.input.evidence.image_disturbed};
     }},
}};

const std::array<Invariant, kInvariants> kInvariantTable = kTable;

namespace {

// With the mode before as a constant, most checks of another one cost nothing.
template <Mode before>
[[gnu::flatten]] Findings check_from(const Step& step) {
  if (step.before.mode != before) __builtin_unreachable();
  Findings findings;
  const auto note = [&findings](std::size_t i, Finding finding) __attribute__((always_inline)) {
    findings.applied |= std::uint64_t{finding.applies} << i;
    findings.broken |= static_cast<std::uint64_t>(finding.applies & !finding.holds) << i;
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (note(I, kTable[I].check(step)), ...);
  }
  (std::make_index_sequence<kInvariants>());
  return findings;
}

}  // namespace

Findings check_all(const Step& step) {
  static constexpr auto kFrom = []<std::size_t... M>(std::index_sequence<M...>) {
    return std::array{check_from<static_cast<Mode>(M)>...};
  }
  (std::make_index_sequence<safety::kModes>());
  return kFrom.at(static_cast<std::size_t>(step.before.mode))(step);
}

}  // namespace biopsy::model_checking
