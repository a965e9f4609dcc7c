// What a tick of the control processes does besides talking to the bus.
#include <gtest/gtest.h>

#include "drivers/digital_io/shared_io.hpp"
#include "drivers/gated_stage.hpp"
#include "planner/plan/seal.hpp"
#include "robot/control/step_runner.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/live/controller_loop.hpp"
#include "robot/live/realtime/latency_histogram.hpp"
#include "robot/live/realtime/tick_clock.hpp"
#include "robot/live/stage_loop.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "robot/procedure/case.hpp"
#include "robot/procedure/prepared_case.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "robot/transport/codec.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

TEST(LiveTick, AllocatesNothingFromSensorToVoltage) {
  const ScratchFolder folder;
  const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
  const Plan& plan = std::get<Plan>(prepared.plan);
  const safety::PlanFacts facts = live::plan_facts(plan, 1);
  const robot::Rehearsal& given = prepared.given.rehearsal;
  sim::SimulatedStage stage(robot::rehearsed_plant(given.model, given.tissues, prepared.layers, 50.0), 1);
  drivers::GatedStage gated(stage);
  safety::EvidenceMemory memory;
  safety::TissueMonitor tissue;
  safety::SupervisorState supervisor = safety::started(1);
  control::RunnerState runner;
  realtime::LatencyHistogram lateness;
  Permit permit;
  DriveRequest request;
  const std::uint64_t tag = planner::plan_tag(plan);
  bool moved = false;
  const realtime::AllocationCount allocations;
  for (std::int64_t tick = 1; tick <= 3'000; ++tick) {
    const Measurement measured = gated.measure();
    biopsy_wire_Measurement wire{};
    transport::encode(measured, wire);
    Measurement received;
    transport::decode(wire, received);
    safety::Observation seen;
    seen.now_us = tick * 1'000;
    seen.measurement = received;
    seen.request = request;
    seen.permit = permit;
    seen.writers = 1;
    seen.estop_a_closed = seen.estop_b_closed = true;
    seen.acquiring = false;
    seen.log_backlog_ms = 0;
    seen.patient_motion_um = 0;
    seen.tissue_residual_um = safety::tissue_residual_um(facts, tissue, received);
    seen.plan_tag = tag;
    seen.config_tag = 1;
    seen.confirmed_tag = {tag, tag};
    safety::SupervisorInput input;
    input.now_us = seen.now_us;
    input.evidence = safety::assess(facts, memory, seen);
    input.self_test = safety::SelfTest::Passed;
    input.local_arm = tick > 100;
    if (tick > 200) input.motion = {1, true};
    input.request = request;
    const auto [next, output] = safety::step(facts, supervisor, input);
    supervisor = next;
    permit = output.permit;
    const control::RunnerStep asked =
        control::run_stage(plan, {}, runner, received, permit, output.stage, false);
    runner = asked.state;
    request = asked.request;
    gated.drive(&request, &permit, seen.now_us, 1);
    lateness.record(tick);
    moved = moved || permit.mode == Mode::Active;
  }
  EXPECT_EQ(allocations.so_far(), 0U);
  EXPECT_TRUE(moved);  // or the claim would be about a robot at rest
}

// The loops as they ship, on a bus of this process. The bus is C and takes memory by malloc; what is written
// in C++ takes it by new.
TEST(LiveTick, OfTheLoopsTakesNoMemoryBesideTheBus) {
  const ScratchFolder folder;
  const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
  Plan plan = std::get<Plan>(prepared.plan);
  const robot::Rehearsal& given = prepared.given.rehearsal;
  sim::SimulatedStage simulated(robot::rehearsed_plant(given.model, given.tissues, prepared.layers, 50.0), 1);
  digital_io::create_shared_io(folder.path());
  digital_io::StageIo converter(folder.path());
  digital_io::SupervisorIo pulse(folder.path());
  digital_io::PanelIo panel(folder.path());
  const digital_io::IoReader reader(folder.path());
  const transport::Participant bus({84, "", 1});
  live::StageLoop stage(bus, simulated, converter, 1);
  live::ControllerLoop controller(bus, 1);
  live::SupervisorLoop supervisor(bus, pulse, reader, 1, 1, safety::SelfTest::Passed);
  transport::Writer<SealedPlan> plans(bus);
  transport::Writer<OperatorAct> acts(bus);
  transport::Writer<LogHealth> log(bus);
  const std::uint64_t tag = planner::plan_tag(plan);
  plans.write({1, planner::canonical_bytes(plan), plan.seal, {tag, tag}});
  stage.heartbeat().note("a trouble that a person should read, longer than any short string");
  controller.heartbeat().note("a trouble that a person should read, longer than any short string");
  OperatorAct act;
  std::uint64_t at_rest = 0, taken = 0;
  bool moved = false;
  for (std::int64_t tick = 1; tick <= 3'000 && !(moved && tick % 500 == 0); ++tick) {
    ++act.seq;
    if (tick > 400) act.token = 1, act.held = true;
    acts.write(act);
    log.write({.seq = act.seq, .backlog_ms = 0, .records = 1});
    panel.set({.arm_key = tick > 300,
               .reset_key = false,
               .estop_a_closed = true,
               .estop_b_closed = true,
               .bench_key = false});
    const bool settled = tick > 200;  // a plan is opened at rest, and that takes memory
    const realtime::NewCount count;
    stage.tick(realtime::monotonic_ns() / 1000);
    supervisor.turn();
    controller.turn(std::chrono::milliseconds(1));
    (settled ? taken : at_rest) += count.so_far();
    moved = moved || supervisor.mode() == Mode::Active;
  }
  EXPECT_EQ(taken, 0U);
  EXPECT_GT(at_rest, 0U) << "nothing is counted";
  EXPECT_TRUE(moved);
}

}  // namespace
}  // namespace biopsy
