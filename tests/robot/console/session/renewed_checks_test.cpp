// The three checks from one target to the next, in OperatorSession without a page.
#include <functional>
#include <map>

#include "planner/plan/seal.hpp"
#include "tests/robot/console/session/held_run.hpp"

namespace biopsy::robot {
namespace {

// A run to its end, with the needle back; then another target is set and its plan confirmed.
struct FurtherTarget : HeldRun {
  explicit FurtherTarget(bool accepted = true) {
    EXPECT_TRUE(accepted ? accept() : reject());
    says(Mode::Retract);
    end();
    const Target target = console.session.prepared().target;
    console.plan(target.p_SE, target.p_SE + 0.8 * (target.p_ST - target.p_SE));
  }
  void end() {
    for (int i = 0; i < 2'000; ++i) says(Mode::Safe);
    console.session.wait_for_results();
    EXPECT_FALSE(state().report.empty());
  }
  bool renew() { return console.send(commands::RenewChecks{1, console.session.planned().seal}); }
  std::uint64_t confirmed_twice() const { return console.sent.back()[1]; }
};

TEST(RenewedChecks, AreGivenByOneActForAFurtherTargetAfterAnAcceptedOne) {
  FurtherTarget run;
  const std::uint64_t tag = planner::plan_tag(std::get<Plan>(run.console.session.prepared().plan));
  run.says(Mode::Safe);
  EXPECT_EQ(run.state().step, console::Step::Check);
  EXPECT_EQ(run.state().ticks, (std::array{false, false, false}));
  EXPECT_EQ(run.confirmed_twice(), 0u);
  EXPECT_GT(run.state().carried_left, 0.0);
  ASSERT_TRUE(run.renew());
  run.says(Mode::Safe);
  EXPECT_EQ(run.confirmed_twice(), tag);
  EXPECT_EQ(run.state().step, console::Step::Arm);
  // Not of the plan after it.
  const Target target = run.console.session.prepared().target;
  run.console.plan(target.p_SE, target.p_SE + 0.9 * (target.p_ST - target.p_SE));
  run.says(Mode::Safe);
  EXPECT_EQ(run.confirmed_twice(), 0u);
}

TEST(RenewedChecks, OfAFirstTargetAreGivenOneByOne) {
  Console console_(read_case("gap"));
  const Target target = console_.session.prepared().target;
  ASSERT_TRUE(console_.open(console_.session.prepared().image.identity.series_uid));
  console_.plan(target.p_SE, target.p_ST);
  EXPECT_EQ(console_.session.state(kPage, console_.now_us).carried_left, 0.0);
  EXPECT_FALSE(console_.send(commands::RenewChecks{1, console_.session.planned().seal}));
  console_.tick_all(true);  // and these do not carry before a run was accepted
  EXPECT_FALSE(console_.send(commands::RenewChecks{1, console_.session.planned().seal}));
}

TEST(RenewedChecks, AreRefusedAfterAnythingThatMayHaveChangedWhatTheySay) {
  const std::map<std::string, std::function<void(FurtherTarget&)>> kEvents = {
      {"STOP", [](FurtherTarget& run) { EXPECT_TRUE(run.console.send(commands::Stop{1})); }},
      {"trip", [](FurtherTarget& run) { run.says(Mode::Trip, safety::Hazard::EStop); }},
      {"lock", [](FurtherTarget& run) { run.says(Mode::Lock); }},
      {"silence", [](FurtherTarget& run) { run.console.session.mark_silent(); }},
      {"another page in control",
       [](FurtherTarget& run) {
         run.console.session.disconnect(kPage);
         run.console.session.connect(kPage);
       }},
      {"the patient unticked",
       [](FurtherTarget& run) {
         const std::string seal = run.console.session.planned().seal;
         EXPECT_TRUE(run.console.send(commands::SetTick{1, console::Tick::Patient, false, seal}));
       }},
      {"a quarter of an hour", [](FurtherTarget& run) { run.console.now_us += 900'000'000; }},
  };
  for (const auto& [name, happens] : kEvents) {
    FurtherTarget run;
    ASSERT_GT(run.state().carried_left, 0.0) << name;
    happens(run);
    run.says(Mode::Safe);
    EXPECT_EQ(run.state().carried_left, 0.0) << name;
    EXPECT_FALSE(run.renew()) << name;
    run.console.tick_all(true);  // one by one they can be given
    run.says(Mode::Safe);
    EXPECT_NE(run.confirmed_twice(), 0u) << name;
  }
}

TEST(RenewedChecks, AreRefusedAfterARunThatWasNotAccepted) {
  FurtherTarget run(false);
  EXPECT_EQ(run.state().carried_left, 0.0);
  EXPECT_FALSE(run.renew());
}

TEST(RenewedChecks, AreOfTheDisplayedAndConfirmedPlanOnly) {
  FurtherTarget run;
  EXPECT_FALSE(run.console.send(commands::RenewChecks{1, std::string(64, '0')}));
  const Target target = run.console.session.prepared().target;
  ASSERT_TRUE(run.console.set_point(Mark::Target, target.p_SE + 0.7 * (target.p_ST - target.p_SE)));
  EXPECT_FALSE(run.renew());
}

}  // namespace
}  // namespace biopsy::robot
