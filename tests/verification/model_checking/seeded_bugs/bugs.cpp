#include "tests/verification/model_checking/seeded_bugs/bugs.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"

namespace biopsy::model_checking {
namespace {

constexpr SeededBug kBugs[] = {
    // Keys and network
    {"arm-without-edge", "Arming asks for the key's level, not its edge.", Part::Supervisor, "decide.cpp",
     "input.local_arm && !state.arm_was_down", "input.local_arm"},
    {"arm-key-keeps-the-hold", "A hold does not run out while the arm key is down.", Part::Supervisor,
     "decide.cpp", "may_stay = t.evidence.still &&", "may_stay = (t.evidence.still || t.input.local_arm) &&"},
    {"reset-without-edge", "A reset key jammed down resets every trip.", Part::Supervisor, "decide.cpp",
     "input.local_reset && !state.reset_was_down", "input.local_reset"},
    {"remote-arm", "Arming over the network is accepted.", Part::Supervisor, "decide.cpp",
     "input.local_arm && !state.arm_was_down",
     "(input.local_arm || input.remote_arm) && !state.arm_was_down"},
    {"remote-reset", "A reset over the network is taken.", Part::Supervisor, "decide.cpp",
     "input.local_reset && !state.reset_was_down",
     "(input.local_reset || input.remote_reset) && !state.reset_was_down"},
    {"reset-needle-out", "A trip is reset with the needle still out.", Part::Supervisor, "decide.cpp",
     "  if (!t.evidence.needle_home) return Refusal::NeedleOut;\n", ""},
    {"reset-with-voltage", "A trip is reset with voltage left.", Part::Supervisor, "decide.cpp",
     "  if (!t.evidence.zero_volts) return Refusal::VoltageLeft;\n", ""},
    {"reset-ends-lock", "The reset key also ends a lock.", Part::Supervisor, "supervisor.cpp",
     "next.mode = mode_after(t.state.mode, event);",
     "next.mode = t.state.mode == Mode::Lock && t.reset_edge ? Mode::Safe : mode_after(t.state.mode, "
     "event);"},
    // Stops
    {"stop-ignored-in-hold", "In Hold only hazards ramp down; a requested stop does not.", Part::Supervisor,
     "decide.cpp",
     "if (t.stop == StopCategory::C1Ramp) return Event::Ramp;\n"
     "  if (t.input.request.finished) return Event::Finished;\n"
     "  const bool may_stay",
     "if ((t.hazards & kC1) != 0) return Event::Ramp;\n"
     "  if (t.input.request.finished) return Event::Finished;\n"
     "  const bool may_stay"},
    {"stop-ignored-after-a-while", "In Hold a requested stop counts for five seconds only.", Part::Supervisor,
     "decide.cpp",
     "if (t.stop == StopCategory::C1Ramp) return Event::Ramp;\n"
     "  if (t.input.request.finished) return Event::Finished;\n"
     "  const bool may_stay",
     "if ((t.hazards & kC1) != 0 || (t.stop == StopCategory::C1Ramp && t.ms < 5'000)) return "
     "Event::Ramp;\n"
     "  if (t.input.request.finished) return Event::Finished;\n"
     "  const bool may_stay"},
    {"c1-before-c0", "Where C0 and C1 hazards are present together the milder is taken.", Part::Supervisor,
     "decide.cpp",
     "  if ((hazards & kC0) != 0) return StopCategory::C0Off;\n"
     "  if ((hazards & kC1) != 0) return StopCategory::C1Ramp;\n",
     "  if ((hazards & kC1) != 0) return StopCategory::C1Ramp;\n"
     "  if ((hazards & kC0) != 0) return StopCategory::C0Off;\n"},
    {"c2-forgotten", "C2 hazards stop nothing.", Part::Supervisor, "decide.cpp",
     "  if (hazards != 0) return StopCategory::C2Hold;\n", ""},
    // The last of its category: a static_assert refuses any other, since hazards are in order of severity.
    {"one-hazard-too-mild", "An interlock that sticks only ramps down.", Part::Supervisor,
     "types/hazards.hpp", "{Hazard::InterlockStuck, StopCategory::C0Off,",
     "{Hazard::InterlockStuck, StopCategory::C1Ramp,"},
    {"go-on-under-a-hazard", "A press goes on from Hold while a C2 hazard stands.", Part::Supervisor,
     "decide.cpp",
     "  if (t.stop != StopCategory::None) return Refusal::Unhealthy;\n  if (!t.state.step_done)",
     "  if (!t.state.step_done)"},
    {"best-is-named", "The mildest hazard is named instead of the worst.", Part::Supervisor,
     "types/hazards.hpp", "static_cast<Hazard>(std::countr_zero(set & kAllHazards))",
     "static_cast<Hazard>(63 - std::countl_zero(set & kAllHazards))"},
    {"epoch-not-raised", "A trip keeps the epoch: permits from before stay alive.", Part::Supervisor,
     "supervisor.cpp", "if (next.mode == Mode::Trip || next.mode == Mode::Lock) ++next.epoch;",
     "if (next.mode == Mode::Lock) ++next.epoch;"},
    // Image and brake
    {"ready-with-the-needle-out", "A needle that friction holds out is no reason not to be ready.",
     Part::Supervisor, "decide.cpp", "t.stop == StopCategory::None && is_needle_back(t)",
     "t.stop == StopCategory::None"},
    {"stays-ready-with-the-needle-out", "A needle pulled out in Ready stays unnoticed.", Part::Supervisor,
     "decide.cpp", "t.hazards != 0 || !is_needle_back(t)", "t.hazards != 0"},
    {"image-ignored", "A press goes on from Hold while an image is taken.", Part::Supervisor, "decide.cpp",
     "  if (t.input.acquiring) return Refusal::ImageRunning;  // the drive would switch in it\n", ""},
    {"image-ignored-when-armed", "The first press moves while an image is taken.", Part::Supervisor,
     "decide.cpp", "if (t.pressed && !t.input.acquiring) return Event::Move;",
     "if (t.pressed) return Event::Move;"},
    {"locked-is-still", "A hold never ends while the brake is on, wherever the needle is.", Part::Supervisor,
     "decide.cpp", "may_stay = t.evidence.still &&", "may_stay = t.evidence.locked &&"},
    {"still-whatever-is-wrong", "A locked needle is held on while the patient moves.", Part::Supervisor,
     "decide.cpp", "t.evidence.still && t.stop == StopCategory::None", "t.evidence.still"},
    {"brake-anywhere", "The brake may take the needle in any hold.", Part::Supervisor, "supervisor.cpp",
     "state.mode == Mode::Hold && state.step_done", "state.mode == Mode::Hold"},
    {"brake-that-is-not-there", "A stage without a brake may lock its needle.", Part::Supervisor,
     "supervisor.cpp", "(arrived && inputs.measurement.brake_fitted)", "arrived"},
    {"brake-kept-in-ramp", "A locked needle stays locked in a ramp down.", Part::Supervisor, "supervisor.cpp",
     "(evidence.locked && (state.mode == Mode::Active || state.mode == Mode::Hold))",
     "(evidence.locked && hv_permitted(state.mode))"},
    {"brake-without-permit", "The gate locks whenever the controller asks.", Part::Gate, "gate.cpp",
     "state.permit.brake && (new_request", "(new_request"},
    {"brake-kept-when-off", "Switching off keeps the brake.", Part::Gate, "gate.cpp",
     "  state.brake_on = false;\n", ""},
    {"brake-kept-on-new-request", "A request that lets go is not followed.", Part::Gate, "gate.cpp",
     "new_request ? request->brake : state.brake_on",
     "new_request && request->brake ? true : state.brake_on"},
    // Hold-to-run
    {"token-not-greater", "The token of the last press is accepted again.", Part::Supervisor, "decide.cpp",
     "input.motion.held && input.motion.token > state.token",
     "input.motion.held && input.motion.token >= state.token"},
    {"token-not-spent", "Only a press that was followed spends its token.", Part::Supervisor,
     "supervisor.cpp", "next.token = std::max(t.state.token, t.input.motion.token);",
     "if (event == Event::Move) next.token = t.input.motion.token;"},
    {"release-ignored", "The message that the button was let go is ignored.", Part::Supervisor, "decide.cpp",
     "return let_go || motion.token > t.state.token", "return motion.token > t.state.token"},
    {"old-press-feeds", "A heartbeat of an older press keeps motion alive.", Part::Supervisor,
     "supervisor.cpp",
     "t.input.motion.held && t.input.motion.token >= t.state.token && t.input.motion.token != 0",
     "t.input.motion.held && t.input.motion.token != 0"},
    {"silence-never-counted-out", "The limit of silence lies one beyond where its counter stops.",
     Part::Supervisor, "decide.cpp", "t.state.ms_since_held >= kHeldTimeout_ms",
     "t.state.ms_since_held > kHeldTimeout_ms"},
    // Stages
    {"depth-check-of-any-step", "The depth check of another step is taken.", Part::Supervisor, "decide.cpp",
     "t.input.depth_accepted && t.input.accepted_step == t.state.step", "t.input.depth_accepted"},
    {"depth-check-of-the-next", "A depth check counts for every step before it.", Part::Supervisor,
     "decide.cpp", "t.input.accepted_step == t.state.step", "t.input.accepted_step >= t.state.step"},
    {"depth-check-of-the-last", "A depth check counts for every step after it.", Part::Supervisor,
     "decide.cpp", "t.input.accepted_step == t.state.step", "t.input.accepted_step <= t.state.step"},
    {"image-from-before", "An image that was taken before the needle arrived is taken for one of this hold.",
     Part::Supervisor, "decide.cpp", "t.input.accepted_since_seq >= t.state.arrived_seq", "true"},
    {"image-of-another-session", "An image of an earlier session of the supervisor counts.", Part::Supervisor,
     "decide.cpp", "t.input.accepted_session == t.state.session && ", ""},
    {"arrival-not-noted", "The arrival keeps the number of the one before.", Part::Supervisor,
     "supervisor.cpp", ", next.arrived_seq = next.seq", ""},
    {"interlock-not-proven", "The self-test passes without the interlock's.", Part::Supervisor, "decide.cpp",
     " && t.evidence.interlock_opens", ""},
    {"step-of-another", "A report about another step ends this one.", Part::Supervisor, "decide.cpp",
     "t.input.request.step_reached && t.input.request.step == t.state.step", "t.input.request.step_reached"},
    {"one-step-too-many", "Behind the last step there is one more.", Part::Supervisor, "decide.cpp",
     "t.state.step >= steps - 1", "t.state.step >= steps"},
    {"step-not-rewound", "Arming goes on at the step where the last run ended.", Part::Supervisor,
     "supervisor.cpp", "next.step = 0, next.step_done = false;", "next.step_done = false;"},
    // Times and voltages
    {"timer-not-reset", "The time of the mode before goes on.", Part::Supervisor, "supervisor.cpp",
     "  next.ms_in_mode = 0;\n", ""},
    {"hold-limit-in-us", "The limit of a hold is taken as microseconds.", Part::Supervisor, "decide.cpp",
     "t.ms >= limits::kHoldMax_ms", "t.ms >= limits::kHoldMax_ms * 1'000"},
    {"boot-never-ends", "A self-test may take for ever.", Part::Supervisor, "decide.cpp",
     "  if (t.ms >= kBootMax_ms) return Event::Lockout;\n", ""},
    {"ramp-never-ends", "The ramp stops at a tenth of where it began.", Part::Supervisor, "supervisor.cpp",
     "std::clamp(state.ms_in_mode, 0, kRamp_ms)", "std::clamp(state.ms_in_mode, 0, kRamp_ms - 25)"},
    {"ramp-not-monitored", "The time of a ramp is not monitored.", Part::Supervisor, "decide.cpp",
     "  if (t.ms >= limits::kRampTime_ms) return Event::RampTooLong;\n", ""},
    {"hold-at-the-steps-limit", "Hold allows what the step allows, not what is there.", Part::Supervisor,
     "supervisor.cpp", "permit.v_max_mV = held_mV(state);",
     "permit.v_max_mV = step_limits(plan, state.step).v_max_mV;"},
    {"ceiling-ignored", "The voltage may rise ahead of what the needle answered.", Part::Supervisor,
     "supervisor.cpp", "std::clamp(evidence.ceiling_mV, 0, step_limits(plan, state.step).v_max_mV)",
     "(void)evidence, step_limits(plan, state.step).v_max_mV"},
    {"hold-follows-the-driver", "A hold begins at whatever an unpermitted driver put out.", Part::Supervisor,
     "supervisor.cpp", "rising_mV(t.plan, t.state, t.evidence) : held_mV(t.state)",
     "step_limits(t.plan, t.state.step).v_max_mV : held_mV(t.state)"},
    {"voltage-ignored-in-safe", "Safe does not look at the voltage.", Part::Supervisor, "decide.cpp",
     "  if (!t.evidence.zero_volts) return Event::VoltagePresent;\n  if (t.stop == StopCategory::None",
     "  if (t.stop == StopCategory::None"},
    {"steepness-not-limited", "A plan may ask for any steepness.", Part::Supervisor, "supervisor.cpp",
     "std::clamp(allowed.slew_up_mV_per_tick, 0, limits::kSlewUpMax_mV_per_tick)",
     "allowed.slew_up_mV_per_tick"},
    {"enabled-in-ready", "The amplifier is enabled before arming.", Part::Supervisor, "types/transitions.hpp",
     "return mode == Mode::Armed || mode", "return mode == Mode::Ready || mode == Mode::Armed || mode"},
    {"pending-is-passed", "A self-test that has not failed counts as passed.", Part::Supervisor, "decide.cpp",
     "t.input.self_test == SelfTest::Passed", "t.input.self_test != SelfTest::Failed"},
    // Gate
    {"permit-lives-on", "The same permit again lives longer.", Part::Gate, "gate.cpp",
     "return permit != nullptr && (permit->session != state.permit.session || permit->seq != "
     "state.permit.seq);",
     "(void)state;\n  return permit != nullptr;"},
    {"life-unlimited", "A permit may lengthen its own life.", Part::Gate, "gate.cpp",
     "std::min(state.permit.ttl_us, limits::kPermitTtl_us)", "state.permit.ttl_us"},
    {"rise-in-hold", "Any permit but C0 allows a rise.", Part::Gate, "gate.cpp",
     "state.permit.mode == Mode::Active && state.permit.stop == StopCategory::None",
     "state.permit.stop != StopCategory::C0Off"},
    {"rise-beside-a-bad-permit", "The voltage rises in the tick in which a permit was refused.", Part::Gate,
     "gate.cpp", "may_increase && new_request && permit_is_good", "may_increase && new_request"},
    {"latch-ends-by-itself", "Any new permit ends the gate's own stop.", Part::Gate, "gate.cpp",
     "if (!permit->hv_enable) state.latched", "state.latched"},
    {"old-epoch-honoured", "A permit from before the trip is honoured.", Part::Gate, "gate.cpp",
     "  if (bound && permit.epoch < state.permit.epoch) return GateVerdict::OldEpoch;\n", ""},
    {"binds-to-an-enabled-permit", "A new supervisor takes over with the drive enabled.", Part::Gate,
     "gate.cpp", "is_off(state) && !permit.hv_enable &&", "is_off(state) &&"},
    {"second-writer-tolerated", "Two writers are as good as one.", Part::Gate, "gate.cpp",
     "writer_count != 1", "writer_count < 1"},
    {"clock-may-go-back", "A clock that stands still, goes back or jumps is not noticed.", Part::Gate,
     "gate.cpp", "!state.started || is_sound_step(state.now_us, now_us)", "!state.started || now_us != 0"},
    {"old-request-counts", "A request seen before is driven again.", Part::Gate, "gate.cpp",
     "new_request ? request->wanted_mV", "request != nullptr ? request->wanted_mV"},
    {"voltage-unlimited", "The permit's envelope is all that limits the voltage.", Part::Gate, "gate.cpp",
     "std::clamp(state.permit.v_max_mV, 0, limits::kDriveMax_mV)", "std::max(state.permit.v_max_mV, 0)"},
};

}  // namespace

std::span<const SeededBug> seeded_bugs() {
  return kBugs;
}

std::string with_bug(const SeededBug& bug, const std::string& source) {
  const std::size_t at = source.find(bug.text);
  const bool twice = at != std::string::npos && source.find(bug.text, at + 1) != std::string::npos;
  if (at == std::string::npos || twice)
    throw ConfigError(
        fmt::format("the text of seeded bug {} stands there {}", bug.id, twice ? "twice" : "nowhere"),
        fmt::format("safety/{}", bug.file), "write the bug again for the present text of the file");
  return source.substr(0, at) + std::string(bug.replacement) + source.substr(at + bug.text.size());
}

}  // namespace biopsy::model_checking
