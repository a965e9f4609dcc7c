// The second person, who confirms the plan of a real stage apart from the console. The console's messages are
// those of one that was taken over: both of its confirmations are always there, for whatever it likes. Two
// plans whose tags agree and whose seals do not are made by changing the seal that is remembered: finding a
// pair takes 2^32 hashes.
#include "tests/robot/cycle/supervise_bench.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::robot {
namespace {

constexpr std::int64_t kMinute_us = 60'000'000;
constexpr std::array kAtRest{Mode::Boot, Mode::Safe, Mode::Ready, Mode::Trip, Mode::Lock};
constexpr std::array kInMotion{Mode::Armed, Mode::Active, Mode::Hold, Mode::Retract};

struct SecondPerson : Supervise {
  SecondPerson() { memory.needs_second_person = true; }
  void confirm(const Sha256& seal) { confirm_plan({1, seal, "B"}, in.now_us, memory); }
  bool counts() { return inputs().confirmed_tag == std::array{tag, tag}; }
  void pass(std::int64_t us) {
    in.now_us += us;
    in.act.at_us = in.log.at_us = in.now_us;
  }

  const std::uint64_t tag = planner::plan_tag(plan);
};

Plan another(const Plan& plan) {
  Plan other = plan;
  other.target_depth = Millimetres(2.5);
  planner::seal(other);
  return other;
}

TEST_F(SecondPerson, IsNeededOfARealStageOnly) {
  verifies("R-69");
  EXPECT_EQ(inputs().confirmed_tag, (std::array{tag, std::uint64_t{0}}));
  memory.needs_second_person = false;
  EXPECT_TRUE(counts());
}

TEST_F(SecondPerson, ConfirmsThePlanWithThisWholeSealAndNoOther) {
  verifies("R-69");
  for (std::size_t byte = 0; byte < plan.seal.size(); ++byte) {
    Sha256 other = plan.seal;
    other[byte] ^= 1;
    confirm(other);
    EXPECT_FALSE(counts()) << "byte " << byte;
  }
  confirm({});
  EXPECT_FALSE(counts());
  confirm(plan.seal);
  EXPECT_TRUE(counts());
}

TEST_F(SecondPerson, IsNotEnoughWithoutTheConsole) {
  verifies("R-69");
  for (const std::array<std::uint64_t, 2>& withdrawn :
       {std::array{tag, std::uint64_t{0}}, {std::uint64_t{0}, tag}, {tag + 1, tag}, {tag, tag - 1}}) {
    confirm(plan.seal);
    SealedPlan sent = sealed(plan);
    sent.confirmed_tag = withdrawn;
    accept_plan(sent, memory);
    EXPECT_EQ(memory.second_person.at_us, 0);
    accept_plan(sealed(plan), memory);
    EXPECT_FALSE(counts()) << "what was withdrawn is confirmed anew by both";
  }
}

TEST_F(SecondPerson, ConfirmsThePlanThatIsSealedNowOrNone) {
  verifies("R-69");
  const Plan other = another(plan);
  confirm(plan.seal);
  accept_plan(sealed(other), memory);
  accept_plan(sealed(plan), memory);
  EXPECT_FALSE(counts()) << "there was another plan meanwhile";
  confirm(other.seal);
  accept_plan(sealed(other), memory);
  EXPECT_EQ(inputs().confirmed_tag[1], 0U) << "who confirmed it was told that it is not taken";
  confirm(other.seal);
  EXPECT_EQ(inputs().confirmed_tag[1], planner::plan_tag(other));
}

TEST_F(SecondPerson, ConfirmsNothingThatTheConsoleDoesNotConfirm) {
  verifies("R-69");
  for (const std::array<std::uint64_t, 2>& given :
       {std::array{tag, std::uint64_t{0}}, {std::uint64_t{0}, tag}}) {
    SealedPlan sent = sealed(plan);
    sent.confirmed_tag = given;
    accept_plan(sent, memory);
    confirm(plan.seal);
    EXPECT_EQ(memory.second_person.at_us, 0);
    accept_plan(sealed(plan), memory);
    EXPECT_FALSE(counts());
  }
}

TEST_F(SecondPerson, LosesItsConfirmationToAPlanWithTheSameTag) {
  verifies("R-69");
  memory.seal[20] ^= 1;  // so the plan before had the tag of this one
  in.request.plan_seal = memory.seal;
  confirm(memory.seal);
  EXPECT_TRUE(counts());
  accept_plan(sealed(plan), memory);
  EXPECT_FALSE(counts());
}

TEST_F(SecondPerson, APlanWithTheSameTagIsAnotherOneInMotion) {
  verifies("R-12");
  for (const Mode mode : kInMotion) {
    memory.state.mode = mode;
    accept_plan(sealed(plan), memory);
    EXPECT_EQ(inputs().plan_tag, tag) << "the very plan";
    memory.state.mode = mode;
    memory.seal[20] ^= 1;
    in.request.plan_seal = memory.seal;
    accept_plan(sealed(plan), memory);
    EXPECT_EQ(inputs().plan_tag, 0U) << safety::name_of(mode);
    EXPECT_EQ(memory.sealed_tag, 0U);
    memory.seal = in.request.plan_seal = plan.seal;
  }
}

TEST_F(SecondPerson, ConfirmsForThreeMinutesAndThenForTheMotionThatBegan) {
  verifies("R-69");
  for (const Mode mode : kAtRest) {
    confirm(plan.seal);
    pass(3 * kMinute_us);
    memory.state.mode = mode;
    EXPECT_TRUE(counts()) << safety::name_of(mode);
    pass(1);
    memory.state.mode = mode;
    EXPECT_FALSE(counts()) << safety::name_of(mode);
  }
  for (const Mode mode : kInMotion) {
    memory.state.mode = Mode::Ready;
    confirm(plan.seal);
    pass(60 * kMinute_us);
    memory.state.mode = mode;
    EXPECT_TRUE(counts()) << safety::name_of(mode);
  }
}

TEST_F(SecondPerson, ConfirmsOneMotion) {
  verifies("R-69");
  confirm(plan.seal);
  memory.state.mode = Mode::Hold;
  in.act.message.stop = StopCategory::C0Off;
  supervise(in, memory);
  ASSERT_FALSE(safety::hv_permitted(memory.state.mode));
  EXPECT_EQ(memory.second_person.at_us, 0);
  EXPECT_EQ(memory.second_person.seal, Sha256{});
  confirm(plan.seal);
  supervise(in, memory);
  EXPECT_NE(memory.second_person.at_us, 0) << "after a stop it is confirmed anew, at rest";
}

TEST_F(SecondPerson, CannotConfirmInMotion) {
  verifies("R-69");
  for (const Mode mode : kInMotion) {
    memory.second_person = {};
    memory.state.mode = mode;
    confirm(plan.seal);
    EXPECT_EQ(memory.second_person.at_us, 0) << safety::name_of(mode);
  }
  for (const Mode mode : kAtRest) {
    memory.second_person = {};
    memory.state.mode = mode;
    confirm(plan.seal);
    EXPECT_EQ(memory.second_person.at_us, in.now_us) << safety::name_of(mode);
  }
}

TEST_F(SecondPerson, SeesInTheDecisionWhichPlanIsConfirmed) {
  const auto told = [&] { return decision_message(supervise(in, memory), in.now_us, 0).confirmed_tag; };
  EXPECT_EQ(told(), 0U);
  confirm(plan.seal);
  EXPECT_EQ(told(), tag);
  memory.plan = {};
  EXPECT_EQ(told(), 0U);
}

TEST_F(SecondPerson, RemembersNoSealOfAPlanThatIsNotTaken) {
  SealedPlan broken = sealed(plan);
  broken.seal[3] ^= 1;
  accept_plan(broken, memory);
  confirm(broken.seal);
  EXPECT_EQ(memory.seal, Sha256{});
  EXPECT_EQ(memory.second_person.at_us, 0);
}

}  // namespace
}  // namespace biopsy::robot
