// What the exploration claims, and that it would see what it looks for.
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/in_parallel.hpp"
#include "tests/safety/situation.hpp"
#include "tests/source_dir.hpp"
#include "tests/verification/model_checking/checks.hpp"
#include "tests/verification/model_checking/gate/gate_explorer.hpp"
#include "tests/verification/model_checking/seeded_bugs/find_violation.hpp"
#include "tests/verification/model_checking/seeded_bugs/mutant_build.hpp"
#include "tests/verification/model_checking/supervisor/counterexample.hpp"
#include "tests/verification/model_checking/supervisor/equivalent_step.hpp"
#include "tests/verification/model_checking/supervisor/explorer.hpp"
#include "tests/verification/model_checking/supervisor/plans.hpp"

namespace biopsy::model_checking {
namespace {

const MutantBuild kMutantBuild{source_dir(), binary_dir() / "generated", BIOPSY_CXX, BIOPSY_BENCH};

const SeededBug& bug_named(std::string_view id) {
  return *std::ranges::find(seeded_bugs(), id, &SeededBug::id);
}

// All counterexamples of what is broken, empty where nothing is.
std::string broken_in(const Explorer& explorer, const PlanFacts& plan, const Exploration& exploration) {
  std::string counterexamples;
  for (std::size_t c = 0; c < kClaims; ++c)
    if (exploration.tallies.claims[c].first)
      counterexamples += counterexample_text(shipped(), plan, explorer, exploration, c);
  return counterexamples;
}

TEST(Exploration, FindsNothingWrongInTheShippedSupervisor) {
  for (const NamedPlan& plan : quick_plans()) {
    Explorer explorer(shipped(), plan.facts, {Grain::Quick, 0, 0, in_parallel});
    const Exploration exploration = explorer.run();
    EXPECT_EQ(broken_in(explorer, plan.facts, exploration), "") << plan.name;
    EXPECT_GT(exploration.transitions, 1'000'000U) << plan.name;
  }
}

TEST(Exploration, ChecksEveryClaimAndReachesEveryTimeInEveryMode) {
  Explorer explorer(shipped(), three_steps(0b010).facts, {Grain::Quick, 0, 0, in_parallel});
  const Exploration exploration = explorer.run();
  for (std::size_t c = 0; c < kClaims; ++c)
    EXPECT_GT(exploration.tallies.claims[c].checked, 0U) << name_of_claim(c);
  const auto longest = [&](Mode mode) { return exploration.longest_ticks[static_cast<std::size_t>(mode)]; };
  EXPECT_EQ(longest(Mode::Boot), 10'000);
  EXPECT_EQ(longest(Mode::Armed), 30'000);
  EXPECT_EQ(longest(Mode::Hold), 10'001);  // of a needle that stays still: counted no further
  EXPECT_EQ(longest(Mode::Retract), 300);
}

TEST(Exploration, FindsNothingWrongInTheShippedGate) {
  const GateExploration exploration = explore_gate(shipped(), true, 0);
  for (std::size_t c = 0; c < kGateInvariants; ++c) {
    EXPECT_EQ(exploration.claims[c].counterexample, "") << kGateInvariantTable[c].name;
    EXPECT_GT(exploration.claims[c].checked, 0U) << kGateInvariantTable[c].name;
  }
  EXPECT_GT(exploration.transitions, 1'000'000U);
}

TEST(Exploration, EveryInputOfTheProductIsVisitedOnceAndAsItsIndexSays) {
  for (std::size_t mode = 0; mode < safety::kModes; ++mode) {
    const InputSpace space(static_cast<Mode>(mode), Grain::Quick);
    SupervisorState state = state_of(0);
    state.token = kToken, state.step = 1;
    std::uint32_t visited = 0;
    space.for_each(0, space.size(), state, [&](std::uint32_t index, const Situation& input) {
      ASSERT_EQ(index, visited++);
      const Situation same = space.at(index, state);
      ASSERT_EQ(input.evidence.clear, same.evidence.clear);
      ASSERT_EQ(input.stop, same.stop);
      ASSERT_EQ(input.motion.token, same.motion.token);
      ASSERT_EQ(input.motion.held, same.motion.held);
      ASSERT_EQ(input.request.step, same.request.step);
      ASSERT_EQ(input.accepted_step, same.accepted_step);
      ASSERT_EQ(input.remote_arm, same.remote_arm);
    });
    EXPECT_EQ(visited, space.size());
  }
}

TEST(Exploration, AStateAndItsKeyAreTheSame) {
  Explorer explorer(shipped(), three_steps(0b010).facts, {Grain::Quick, 0, 0, in_parallel});
  const std::uint64_t states = explorer.run().states;
  for (std::uint32_t i = 0; i < states; i += 7) {
    const SupervisorState state = explorer.state(i);
    ASSERT_EQ(key_of(state_of(key_of(state))), key_of(state));
  }
}

TEST(EquivalentStep, CoverEveryHazardAndEveryRelationTheProductLeavesOut) {
  const InputSpace space(Mode::Hold, Grain::Quick);
  SupervisorState state = state_of(0);
  state.mode = Mode::Hold, state.token = kToken, state.step = 1;
  safety::HazardSet seen = 0;
  bool before = false, after = false;
  for (std::uint32_t i = 0; i < space.size(); ++i) {
    const Situation input = space.at(i, state);
    const EquivalentStep equivalent = equivalent_step(state, input, i);
    seen |= equivalent.input.evidence.hazards();
    before = before || equivalent.input.accepted_step < equivalent.state.step;
    after = after || equivalent.input.accepted_step > equivalent.state.step;
    ASSERT_EQ(input.motion.token > state.token, equivalent.input.motion.token > equivalent.state.token);
    ASSERT_EQ(input.motion.token == state.token, equivalent.input.motion.token == equivalent.state.token);
    ASSERT_EQ(input.motion.token == 0, equivalent.input.motion.token == 0);
  }
  EXPECT_EQ(seen, safety::kAllHazards);
  EXPECT_TRUE(before && after);
}

// What lets single hazards be left out of the product: each stands alone for its class in some equivalent.
TEST(EquivalentStep, HasEachHazardAloneForItsClass) {
  const InputSpace space(Mode::Hold, Grain::Quick);
  SupervisorState state = state_of(0);
  state.mode = Mode::Hold, state.token = kToken, state.step = 1;
  std::array<int, safety::kHazards> alone{};
  for (std::uint32_t i = 0; i < space.size() / 8; ++i) {
    const safety::HazardSet others = equivalent_step(state, space.at(i, state), i).input.evidence.hazards();
    for (std::size_t h = 0; h < safety::kHazards; ++h)
      if ((others & class_of(static_cast<safety::Hazard>(h))) == safety::bit(static_cast<safety::Hazard>(h)))
        ++alone[h];
  }
  for (std::size_t h = 0; h < safety::kHazards; ++h)
    EXPECT_GT(alone[h], 100) << safety::name_of(static_cast<safety::Hazard>(h));
}

TEST(EquivalentStep, IsTheSameWhereAnotherWasWrittenBefore) {
  const InputSpace space(Mode::Hold, Grain::Full);
  SupervisorState state = state_of(0);
  state.mode = Mode::Hold, state.token = kToken, state.step = 1;
  EquivalentStep written;
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    const Situation input = space.at(i * 167, state);
    write_equivalent_step(state, input, i, written);
    const EquivalentStep fresh = equivalent_step(state, input, i);
    const auto [next, output] = safety::step(three_steps(0b010).facts, fresh.state, fresh.input);
    const auto [next_written, output_written] =
        safety::step(three_steps(0b010).facts, written.state, written.input);
    ASSERT_EQ(output.permit, output_written.permit) << i;
    ASSERT_EQ(output.refusal, output_written.refusal) << i;
    ASSERT_EQ(key_of(next), key_of(next_written)) << i;
  }
}

// What lets six plans be explored with thin inputs.
TEST(EquivalentStep, HasEveryPlanThatConfirmsThePresentStepAlike) {
  const PlanFacts plan = three_steps(0b010).facts;
  const EquivalentPlans plans(plan);
  SupervisorState state = state_of(0);
  for (state.step = 0; state.step < 3; ++state.step) {
    std::set<unsigned> seen;
    for (std::uint64_t number = 0; number < 1'000; ++number) {
      const PlanFacts& other = plans.of(state, number);
      ASSERT_EQ(other.steps[state.step].image_confirms, plan.steps[state.step].image_confirms);
      unsigned confirms = 0;
      for (unsigned i = 0; i < 3; ++i) confirms |= unsigned{other.steps[i].image_confirms} << i;
      seen.insert(confirms);
    }
    EXPECT_EQ(seen.size(), 4U) << state.step;
  }
}

// A step that looks at a neighbour's confirmation is found by equivalents, whose plans differ in it.
TEST(EquivalentStep, FindsAStepThatReadsAnothersConfirmation) {
  const Subject nosy{[](const PlanFacts* plan, const SupervisorState* state, const Situation* input) {
                       PlanFacts shifted = *plan;
                       shifted.steps[1].image_confirms = plan->steps[0].image_confirms;
                       return safety::step(shifted, *state, *input);
                     },
                     shipped().gate};
  Explorer explorer(nosy, three_steps(0b010).facts, {Grain::Thin, 0, 0, in_parallel});
  const Exploration exploration = explorer.run();
  EXPECT_GT(exploration.tallies.claims[number_of(GraphClaim::ForgottenDecidesNothing)].broken, 0U);
}

// A hazard that is not named, or that stands for another class, is found though the product has it not.
TEST(EquivalentStep, FindsAHazardThatIsOverlooked) {
  const Subject blind{[](const PlanFacts* plan, const SupervisorState* state, const Situation* input) {
                        Situation seen = *input;
                        seen.evidence.clear |= safety::bit(safety::Hazard::LogBacklog);
                        return safety::step(*plan, *state, seen);
                      },
                      shipped().gate};
  Explorer explorer(blind, three_steps(0b010).facts, {Grain::Quick, 1, 0, in_parallel});
  const Exploration exploration = explorer.run();
  EXPECT_GT(exploration.tallies.claims[number_of(GraphClaim::ForgottenDecidesNothing)].broken, 0U);
}

TEST(Counterexample, OfASeededBugIsATraceTickByTick) {
  const SeededSubject subject(kMutantBuild, &bug_named("depth-check-of-any-step"));
  const Violations caught = find_violation(subject.get(), Part::Supervisor, {});
  ASSERT_EQ(caught.claims, std::vector<std::string>{"depth-check"});
  EXPECT_EQ(caught.counterexamples.front(),
            R"(       0 ms  boot | 0 V measured -> safe (self-test passed)
       1 ms  safe | 0 V measured -> ready (healthy and plan sealed)
       2 ms  ready | 0 V measured, arm key turned -> armed (armed on the device), up to 0 V
       3 ms  armed | 0 V measured, motion button held (new press) -> active (motion button pressed), step 1, up to 0 V, may rise
       4 ms  active | controller reached this step -> hold (step reached), step 1 done, up to 0 V
       5 ms  hold | motion button held (new press) -> active (motion button pressed), step 2, up to 0 V, may rise
       6 ms  active | controller reached this step -> hold (step reached), step 2 done, up to 0 V
       7 ms  hold | motion button held (new press), depth check accepts another step, image from 7 -> active (motion button pressed), step 3, up to 0 V, may rise
  broken:    depth-check: Past a step that an image confirms only with a depth check of that very step and hold.
)");
}

TEST(Counterexample, OfATimeLimitThatNeverEndsHasItsDuration) {
  const SeededSubject subject(kMutantBuild, &bug_named("hold-limit-in-us"));
  const Violations caught = find_violation(subject.get(), Part::Supervisor, {});
  ASSERT_FALSE(caught.claims.empty());
  EXPECT_NE(caught.counterexamples.front().find("for 10.000 s: hold"), std::string::npos)
      << caught.counterexamples.front();
}

TEST(SeededBugs, AreEachFoundOnceInTheTextOfTheirFile) {
  for (const SeededBug& bug : seeded_bugs()) {
    const std::string source = read_file(source_dir() / "safety" / bug.file);
    EXPECT_NE(with_bug(bug, source), source) << bug.id;
    EXPECT_THROW(with_bug(bug, source + source), ConfigError) << bug.id;
    EXPECT_THROW(with_bug(bug, ""), ConfigError) << bug.id;
  }
  EXPECT_GE(seeded_bugs().size(), 26U);
}

TEST(SeededBugs, EachCompile) {
  const std::span<const SeededBug> bugs = seeded_bugs();
  in_parallel(bugs.size(), [&](std::size_t i) { check_compiles(kMutantBuild, bugs[i]); });
}

TEST(SeededBugs, OfTheGateAreCaught) {
  const SeededSubject subject(kMutantBuild, &bug_named("permit-lives-on"));
  EXPECT_EQ(find_violation(subject.get(), Part::Gate, {}).claims, std::vector<std::string>{"gate-life"});
  const SeededSubject kept(kMutantBuild, &bug_named("brake-kept-on-new-request"));
  EXPECT_EQ(find_violation(kept.get(), Part::Gate, {}).claims,
            std::vector<std::string>{"gate-brake-follows-the-request"});
}

TEST(SeededBugs, AnUnchangedCopyIsAsCleanAsTheShippedCode) {
  const SeededSubject subject(kMutantBuild, nullptr);
  EXPECT_TRUE(find_violation(subject.get(), Part::Gate, {}).claims.empty());
  EXPECT_TRUE(find_violation(subject.get(), Part::Supervisor, {}).claims.empty());
}

}  // namespace
}  // namespace biopsy::model_checking
