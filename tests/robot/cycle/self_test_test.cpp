// What the supervisor asks of itself before it starts.
#include "robot/cycle/self_test.hpp"

#include <gtest/gtest.h>

namespace biopsy::robot {
namespace {

using namespace safety;

TEST(SelfTest, IsPassedByWhatShips) {
  EXPECT_EQ(self_test(), SelfTest::Passed);
}

TEST(SelfTest, IsFailedByEvidenceThatTrusts) {
  EXPECT_EQ(self_test({.assess = [](const PlanFacts&, EvidenceMemory&,
                                    const SupervisorInputs&) { return Evidence{.clear = kAllHazards}; }}),
            SelfTest::Failed);
}

TEST(SelfTest, IsFailedByEvidenceThatMissesTooMuchVoltage) {
  EXPECT_EQ(self_test({.assess =
                           [](const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen) {
                             Evidence found = assess(plan, memory, seen);
                             found.clear |= bit(Hazard::OverVoltage);
                             return found;
                           }}),
            SelfTest::Failed);
}

// One function for each, as it is called through a pointer.
Hazard overlooked = Hazard::None;
bool Evidence::*trusted = nullptr;

// Of an input of which nothing is known: the first of a start.
Evidence overlooks(const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen) {
  Evidence found = assess(plan, memory, seen);
  if (overlooked != Hazard::None) found.clear |= bit(overlooked);
  if (trusted != nullptr && seen.now_us == 0) found.*trusted = true;
  return found;
}

TEST(SelfTest, IsFailedByEvidenceThatTakesOneUnknownForGood) {
  for (const Hazard hazard :
       {Hazard::EStop, Hazard::SecondWriter, Hazard::PlanChanged, Hazard::ConfigChanged,
        Hazard::PlanUnconfirmed, Hazard::LogBacklog, Hazard::WrongAnswer, Hazard::PanelUntested}) {
    overlooked = hazard;
    EXPECT_EQ(self_test({.assess = overlooks}), SelfTest::Failed) << name_of(hazard);
  }
  overlooked = Hazard::None;
  for (bool Evidence::*const flag : {&Evidence::zero_volts, &Evidence::needle_home}) {
    trusted = flag;
    EXPECT_EQ(self_test({.assess = overlooks}), SelfTest::Failed);
  }
  trusted = nullptr;
  EXPECT_EQ(self_test({.assess = overlooks}), SelfTest::Passed);
}

TEST(SelfTest, IsFailedByEvidenceThatFindsTooMuchVoltageAtNone) {
  EXPECT_EQ(self_test({.assess =
                           [](const PlanFacts& plan, EvidenceMemory& memory, const SupervisorInputs& seen) {
                             Evidence found = assess(plan, memory, seen);
                             found.clear &= ~bit(Hazard::OverVoltage);
                             return found;
                           }}),
            SelfTest::Failed);
}

Mode faulty_mode = Mode::Boot;
bool faulty_enable = false;

// Goes on in one mode, or enables high voltage there; Boot: leaves it although the interlock is not proven.
std::pair<SupervisorState, SupervisorOutput> misbehaves(const PlanFacts& plan, const SupervisorState& state,
                                                        const SupervisorInputs& inputs,
                                                        const Evidence& evidence) {
  auto result = step(plan, state, inputs, evidence);
  if (state.mode != faulty_mode) return result;
  if (faulty_enable) {
    result.second.permit.hv_enable = true;
  } else if (state.mode == Mode::Boot) {
    result.first.mode = Mode::Safe;
  } else {
    result.first.mode = state.mode;
  }
  return result;
}

TEST(SelfTest, IsFailedByASupervisorThatIsWrongInOneModeAlone) {
  for (const Mode mode : {Mode::Boot, Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract})
    for (const bool enable : {false, true}) {
      faulty_mode = mode, faulty_enable = enable;
      EXPECT_EQ(self_test({.step = misbehaves}), SelfTest::Failed) << name_of(mode) << enable;
    }
}

TEST(SelfTest, IsFailedByASupervisorThatNeverLeavesBoot) {
  using Result = std::pair<SupervisorState, SupervisorOutput>;
  EXPECT_EQ(self_test({.step = [](const PlanFacts& plan, const SupervisorState& state,
                                  const SupervisorInputs& inputs, const Evidence& evidence) -> Result {
              Result result = step(plan, state, inputs, evidence);
              if (state.mode == Mode::Boot) result.first.mode = Mode::Boot;
              return result;
            }}),
            SelfTest::Failed);
}

TEST(SelfTest, IsFailedByAnAnswerThatIsLargerThanTheRightOne) {
  EXPECT_EQ(self_test({.answer_to = [](std::uint32_t, std::int32_t, Mode, std::uint32_t) -> std::uint32_t {
              return UINT32_MAX;
            }}),
            SelfTest::Failed);
}

TEST(SelfTest, IsFailedByASupervisorThatGoesOnOrNeverStarts) {
  using Result = std::pair<SupervisorState, SupervisorOutput>;
  EXPECT_EQ(self_test({.step = [](const PlanFacts&, const SupervisorState& state, const SupervisorInputs&,
                                  const Evidence&) -> Result {
              return {state, {}};
            }}),
            SelfTest::Failed);
  EXPECT_EQ(self_test({.step = [](const PlanFacts& plan, const SupervisorState& state,
                                  const SupervisorInputs& inputs, const Evidence& evidence) -> Result {
              Result result = step(plan, state, inputs, evidence);
              result.second.permit.hv_enable = true;
              return result;
            }}),
            SelfTest::Failed);
}

TEST(SelfTest, IsFailedByAWrongAnswerAndByASealThatHoldsOnAnything) {
  EXPECT_EQ(self_test({.answer_to = [](std::uint32_t, std::int32_t, Mode, std::uint32_t) -> std::uint32_t {
              return 7;
            }}),
            SelfTest::Failed);
  EXPECT_EQ(self_test({.seal_holds = [](const Plan&) { return true; }}), SelfTest::Failed);
  EXPECT_EQ(self_test({.seal_holds = [](const Plan&) { return false; }}), SelfTest::Failed);
}

}  // namespace
}  // namespace biopsy::robot
