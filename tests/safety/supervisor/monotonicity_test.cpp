// Worse inputs never permit more, over long seeded walks; healthy procedures never stop.
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "tests/safety/rig.hpp"
#include "tests/safety/situation.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::safety {
namespace {

class Dice {
 public:
  explicit Dice(std::uint32_t seed) : random_(seed) {}
  bool one_in(unsigned n) { return random_() % n == 0; }
  std::uint32_t below(unsigned n) { return static_cast<std::uint32_t>(random_() % n); }

 private:
  std::mt19937 random_;
};

// Mostly healthy, so that the walk gets everywhere; every bit is bad now and then.
Situation random_input(Dice& dice, const SupervisorState& state) {
  Situation input;
  input.evidence.clear = kAllHazards;
  if (dice.one_in(40)) input.evidence.clear &= ~bit(static_cast<Hazard>(dice.below(kHazards)));
  input.evidence.zero_volts =
      state.mode == Mode::Active || state.mode == Mode::Hold ? dice.one_in(2) : !dice.one_in(20);
  input.evidence.needle_home = !dice.one_in(5);
  input.evidence.needle_back = !dice.one_in(5);
  input.evidence.locked = dice.one_in(3);
  input.evidence.still = input.evidence.locked && dice.one_in(2);
  input.acquiring = dice.one_in(10);
  input.evidence.drive_mV = static_cast<std::int32_t>(dice.below(8'000'001));
  input.self_test = dice.one_in(10) ? static_cast<SelfTest>(dice.below(3)) : SelfTest::Passed;
  input.local_arm = dice.one_in(2);
  input.local_reset = dice.one_in(2);
  input.remote_arm = dice.one_in(10);
  input.remote_reset = dice.one_in(10);
  if (dice.one_in(30)) input.stop = static_cast<StopCategory>(dice.below(4));
  if (!dice.one_in(4)) input.motion = {state.token + dice.below(2), !dice.one_in(8)};
  input.request.step = dice.one_in(8) ? dice.below(4) : state.step;
  input.request.step_reached = dice.one_in(8);
  input.request.finished = dice.one_in(60);
  input.depth_accepted = !dice.one_in(3);
  input.accepted_step = dice.one_in(8) ? dice.below(4) : state.step;
  input.accepted_session = state.session;
  input.accepted_since_seq = dice.one_in(8) ? dice.below(state.seq + 1) : state.seq;
  input.evidence.interlock_opens = !dice.one_in(5);
  input.evidence.elapsed_ms = static_cast<std::int32_t>(dice.below(3));
  return input;
}

// The partial order of badness: each makes an input worse in one respect.
using Worsening = void (*)(Situation&, Dice&);
constexpr Worsening kWorsenings[] = {
    [](Situation& s, Dice& dice) { s.evidence.clear &= ~bit(static_cast<Hazard>(dice.below(kHazards))); },
    [](Situation& s, Dice&) { s.evidence.zero_volts = false; },
    [](Situation& s, Dice&) { s.evidence.needle_home = false; },
    [](Situation& s, Dice&) { s.evidence.needle_back = false; },
    [](Situation& s, Dice&) { s.evidence.still = false; },
    [](Situation& s, Dice&) { s.acquiring = true; },
    [](Situation& s, Dice&) {
      s.self_test = s.self_test == SelfTest::Passed ? SelfTest::Pending : SelfTest::Failed;
    },
    [](Situation& s, Dice&) { s.local_arm = false; },
    [](Situation& s, Dice&) { s.local_reset = false; },
    [](Situation& s, Dice&) {
      s.stop = static_cast<StopCategory>(std::min(static_cast<int>(s.stop) + 1, 3));
    },
    [](Situation& s, Dice&) { s.motion.held = false; },
    [](Situation& s, Dice&) { s.motion = {}; },
    [](Situation& s, Dice&) { s.request.step_reached = true; },
    [](Situation& s, Dice&) { s.request.finished = true; },
    [](Situation& s, Dice&) { s.depth_accepted = false; },
    [](Situation& s, Dice&) { s.evidence.drive_mV /= 2; },
    [](Situation& s, Dice&) { s.evidence = Evidence{}; },
    [](Situation& s, Dice&) { s.evidence.interlock_opens = false; },
    [](Situation& s, Dice&) { s.evidence.elapsed_ms += 2; },
    [](Situation& s, Dice&) { s.accepted_since_seq /= 2; },
    [](Situation& s, Dice&) { s.accepted_since_seq = 0xFFFF'FFFFU; },
    [](Situation& s, Dice&) { ++s.accepted_session; },
};
constexpr unsigned kRelease = 10, kNoMotion = 11;

std::int32_t rise_limit(const Permit& permit) {
  return permit.slew_up_mV_per_tick > 0 ? permit.v_max_mV : 0;
}

TEST(Supervisor, AnInputWorseInOneBitNeverGivesAMorePermissiveOutput) {
  verifies("R-48");
  const PlanFacts plan = three_step_plan();
  Dice dice(2024);
  std::array<int, kModes> visits{};
  SupervisorState state = started(5);
  Permit before;
  for (int i = 0; i < 400'000; ++i) {
    if (dice.one_in(500)) state = started(5), before = {};
    if (dice.one_in(50))
      state.ms_in_mode += static_cast<std::int32_t>(dice.below(10'000));  // timers elapse as well
    ++visits[static_cast<std::size_t>(state.mode)];
    const Situation input = random_input(dice, state);
    const auto [next, output] = step(plan, state, input);
    unsigned way = dice.below(std::size(kWorsenings));
    // Saying nothing is worse than holding the button, but a release or a second press is worse than saying
    // nothing.
    const bool second_press = state.mode == Mode::Active && input.motion.token > state.token;
    if (way == kNoMotion && (!input.motion.held || second_press)) way = kRelease;
    Situation worse_input = input;
    kWorsenings[way](worse_input, dice);
    const auto [worse_next, worse] = step(plan, state, worse_input);
    const auto what = [&, w = worse_next, n = next] {
      return std::string(name_of(state.mode)) + " -> " + std::string(name_of(n.mode)) + ", worse in way " +
             std::to_string(way) + " -> " + std::string(name_of(w.mode));
    };
    ASSERT_LE(permissiveness(worse_next.mode), permissiveness(next.mode)) << what();
    ASSERT_LE(rise_limit(worse.permit), rise_limit(output.permit)) << what();
    ASSERT_LE(worse.permit.slew_up_mV_per_tick, output.permit.slew_up_mV_per_tick) << what();
    ASSERT_LE(worse.permit.depth_max_um, output.permit.depth_max_um) << what();
    ASSERT_LE(worse.permit.v_max_mV, std::max(output.permit.v_max_mV, before.v_max_mV)) << what();
    // A ramp that is not finished keeps its amplifier; nothing else does.
    if (worse_next.mode != Mode::Retract) {
      ASSERT_LE(worse.permit.hv_enable, output.permit.hv_enable) << what();
    }
    state = next;
    before = output.permit;
  }
  for (std::size_t mode = 0; mode < kModes; ++mode)
    EXPECT_GT(visits[mode], 200) << name_of(static_cast<Mode>(mode));
}

constexpr void (*kWorseObservations[])(SupervisorInputs&) = {
    [](SupervisorInputs& s) { s.estop_a_closed = false; },
    [](SupervisorInputs& s) { s.estop_b_closed = false; },
    [](SupervisorInputs& s) { s.panel_read = false; },
    [](SupervisorInputs& s) { s.writers = 0; },
    [](SupervisorInputs& s) { s.log_backlog_ms = 5'000; },
    [](SupervisorInputs& s) { s.patient_motion_um = -1; },
    [](SupervisorInputs& s) { s.tissue_residual_um = -1; },
    [](SupervisorInputs& s) { s.plan_tag = 0; },
    [](SupervisorInputs& s) { s.config_tag = 0; },
    [](SupervisorInputs& s) { s.confirmed_tag[0] = 0; },
    [](SupervisorInputs& s) { s.measurement.answered_seq = 0; },
    [](SupervisorInputs& s) { s.now_us -= 1'000; },
};

TEST(Supervisor, WorseObservationsNeverClearAHazard) {
  verifies("R-48");
  Rig rig;
  Dice dice(5);
  ASSERT_TRUE(rig.go_active());
  for (int i = 0; i < 4'000; ++i) {
    rig.on_observation = [&](SupervisorInputs& seen) {
      if (dice.one_in(3)) seen.estop_a_closed = false;
      if (dice.one_in(3)) seen.estop_b_closed = false;
      if (dice.one_in(9)) seen.measurement.answer ^= 1;
      SupervisorInputs worse = seen;
      kWorseObservations[dice.below(std::size(kWorseObservations))](worse);
      EvidenceMemory memory = rig.memory, memory_of_worse = rig.memory;
      const HazardSet clear = assess(rig.plan, memory, seen).clear;
      ASSERT_EQ(assess(rig.plan, memory_of_worse, worse).clear & ~clear, 0U);
    };
    rig.tick();
  }
}

TEST(Nuisance, APlannedPunctureOfHalfAMillimetreIsNoBreakThrough) {
  verifies("R-17");
  Rig rig;
  rig.wanted_mV = 5'000'000;
  ASSERT_TRUE(rig.go_active());
  for (int i = 0; i < 4; ++i) rig.push_um += 125, rig.tick();
  rig.run(100);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

TEST(Nuisance, SingleBadSamplesAndMessagesDoNotStop) {
  Rig rig;
  ASSERT_TRUE(rig.go_active());
  int tick = 0;
  rig.on_measurement = [&](Measurement& m) {
    ++tick %= 500;
    if (tick == 100) m.laser_valid = false;
    if (tick == 150) m.current_nA += 40'000'000;
    if (tick == 200) m.monitor_mV = 8'500'000;
    if (tick == 300) m.depth_um += 3'000;
    if (tick == 400) m.answer ^= 7;
  };
  rig.run(2'000);
  EXPECT_EQ(rig.state.mode, Mode::Active) << name_of(rig.state.reason);
}

}  // namespace
}  // namespace biopsy::safety
