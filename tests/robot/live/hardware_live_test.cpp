// The real processes on the laboratory's stage, whose board is not there: the vendor's library of the tests
// stands in its place, in the stage's process and in the supervisor's.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "planner/plan/seal.hpp"
#include "robot/common/operator_name.hpp"
#include "tests/robot/cli/command.hpp"
#include "tests/robot/live/laboratory.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::live_tests {
namespace {

TEST(HardwareLive, ACommissionedStageGetsReadyAndNothingMovesBeforeAHandTurnsTheKey) {
  verifies("R-40");
  const Lab lab;
  lab.commission();
  on_a_steady_host([&]() -> std::string {
    const ScratchFolder run;
    const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), run.path());
    robot::LiveSession session(lab.options, "nidaqmx", lab.hardware, prepared, run.path());
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    robot::OperatorInputs asking = robot::OperatorInputs::idle();  // over the network: which arms nothing
    asking.remote_arm = true;
    bool ready = false;
    std::string hazard;
    Measurement seen;
    for (int n = 0; n < 3'000; ++n) {
      const std::optional<robot::CycleSample> cycle = session.robot().tick(asking);
      if (!cycle) continue;
      ready = ready || cycle->record.supervisor.permit.mode == Mode::Ready;
      hazard = robot::hazard_text(cycle->record.supervisor.worst, cycle->record.panel_unread_ms);
      seen = cycle->record.measurement;
      EXPECT_FALSE(cycle->record.supervisor.permit.hv_enable);
    }
    EXPECT_TRUE(seen.laser_valid);
    EXPECT_NEAR(seen.depth_um, 0, 100);
    EXPECT_EQ(seen.command_mV, 0);
    session.stop();
    return ready ? "" : "the robot never got ready: " + hazard;
  });
}

// The robot's state while another program runs, which is here the second person. `hazard`: the last that was
// present meanwhile; a reset is needed after some of them. `meanwhile`: ten times a second.
Mode mode_during(robot::LiveSession& session, std::string& hazard, const std::function<void()>& person,
                 int ticks, const std::function<void()>& meanwhile) {
  std::atomic<bool> done{false};
  std::jthread thread([&] { person(), done = true; });
  Mode mode = Mode::Boot;
  hazard = "no hazard";
  for (int n = 0; n < ticks || !done; ++n) {
    const std::optional<robot::CycleSample> cycle = session.robot().tick(robot::OperatorInputs::idle());
    if (n % 100 == 0) meanwhile();
    if (!cycle) continue;
    mode = cycle->record.supervisor.permit.mode;
    const safety::Hazard worst = cycle->record.supervisor.worst;
    if (worst != safety::Hazard::None) hazard = robot::hazard_text(worst, cycle->record.panel_unread_ms);
  }
  return mode;
}

// A console that was taken over sends a plan of its own with both confirmations: here one that says of its
// target another depth than its points, then the planned one.
TEST(HardwareLive, GetsReadyOnlyOnceASecondPersonConfirmedThePlanWithTheirOwnProgram) {
  verifies("R-69");
  const Lab lab;
  lab.commission();
  on_a_steady_host([&]() -> std::string {
    const ScratchFolder run;
    const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), run.path());
    const Plan& plan = std::get<Plan>(prepared.plan);
    robot::LiveSession session(lab.options, "nidaqmx", lab.hardware, prepared, run.path());
    session.wait_until_healthy();
    cli_tests::Outcome outcome;
    std::string hazard;
    const auto send = [&](const Plan& sent) {
      const std::uint64_t tag = planner::plan_tag(sent);
      session.robot().send_plan(sent, {tag, tag});
    };
    std::function<void()> meanwhile = [] {};
    const std::filesystem::path said = run.path() / "confirm.txt";
    const auto confirm = [&](const Plan& sent, const std::string& typed, const std::string& name, int ticks) {
      send(sent);
      return mode_during(
          session, hazard,
          [&] {
            outcome =
                cli_tests::shell("(" + typed + ") | BIOPSY_OPERATOR='" + name + "' '" + cli_tests::program() +
                                 "' confirm --json '" + run.path().string() + "' > '" + said.string() +
                                 "' 2>&1; code=$?; cat '" + said.string() + "'; exit $code");
          },
          ticks, meanwhile);
    };
    const auto refuses = [&](const Plan& sent, const std::string& typed, const std::string& why,
                             const std::string& name = "Dr. B") {
      EXPECT_NE(confirm(sent, typed, name, 300), Mode::Ready) << why;
      EXPECT_EQ(outcome.code, 1) << outcome.text;
      EXPECT_NE(outcome.text.find(why), std::string::npos) << outcome.text;
    };
    const std::string seal = hex(plan.seal);
    Plan deeper = plan;
    deeper.target_depth = plan.target_depth + Millimetres(1.0);
    deeper.steps.back().depth = deeper.target_depth;
    deeper.limits.depth_max = deeper.target_depth + Millimetres(1.0);
    planner::seal(deeper);
    refuses(deeper, "echo " + hex(deeper.seal).substr(0, 8),
            fmt::format("by its points the target is {:.2f} mm deep", plan.target_depth.value));
    refuses(plan, "echo 00000000", "not the seal of this plan");
    refuses(plan, "echo " + seal.substr(0, 7), "not the seal of this plan");
    refuses(plan, "true", "nothing was typed");
    refuses(plan, "echo " + seal, "another person", operator_name());
    Plan slower = plan;
    slower.steps.front().speed = MillimetresPerSecond(0.5 * plan.steps.front().speed.value);
    planner::seal(slower);
    const auto shown = [&] { return file_content(said).find("needle goes") != std::string::npos; };
    std::filesystem::remove(said);
    meanwhile = [&, sent = false]() mutable {
      if (sent || !std::filesystem::exists(said) || !shown()) return;
      send(slower), sent = true;
    };
    refuses(plan,
            "timeout 60 sh -c \"until grep -qs 'needle goes' '" + said.string() +
                "'; do sleep 0.1; done\"; sleep 2; echo " + seal,
            "no longer confirms this plan");
    meanwhile = [] {};
    const Mode right = confirm(plan, "echo " + seal.substr(0, 8), "Dr. M\xC3\xBCller", 3'000);
    if (outcome.code != 0) return std::string(kNotInTime) + ": " + outcome.text;
    EXPECT_NE(outcome.text.find(fmt::format("needle goes   {:.2f} mm deep", plan.target_depth.value)),
              std::string::npos)
        << outcome.text;
    const auto told = nlohmann::json::parse(outcome.text.substr(outcome.text.rfind("{\n")));
    EXPECT_EQ(told,
              (nlohmann::json{
                  {"confirmed", true}, {"seal", seal}, {"operator", "Dr. M\xC3\xBCller"}, {"why", nullptr}}));
    session.stop();
    return right == Mode::Ready ? "" : "the robot never got ready: " + hazard;
  });
}

TEST(HardwareLive, WithoutItsCommissioningRecordTheStageDoesNotStart) {
  const Lab lab;
  EXPECT_NE(lab.refusal().find("commissioning.json"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithAnotherConfigurationThanTheCommissionedOneItDoesNotStart) {
  const Lab lab;
  lab.commission();
  std::ofstream(lab.hardware.config, std::ios::app) << "\n# one more line\n";
  EXPECT_NE(lab.refusal().find("configuration"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithoutTheRelaysContactTheStageDoesNotStart) {
  verifies("R-65");
  const Lab lab;
  std::string text = file_content(lab.hardware.config);
  const std::size_t from = text.find("[relay_contact]");
  text.erase(from, text.find("[supervisor_pulse]") - from);
  std::ofstream(lab.hardware.config) << text;
  lab.commission();
  EXPECT_NE(lab.refusal().find("relay is not read back"), std::string::npos) << lab.refusal();
}

TEST(HardwareLive, WithoutALineForItsPulseTheSupervisorDoesNotStart) {
  verifies("R-43");
  const Lab lab;
  std::string text = file_content(lab.hardware.config);
  text.erase(text.find("[supervisor_pulse]"));
  std::ofstream(lab.hardware.config) << text;
  EXPECT_NE(lab.refusal().find("half of the interlock"), std::string::npos) << lab.refusal();
}

}  // namespace
}  // namespace biopsy::live_tests
