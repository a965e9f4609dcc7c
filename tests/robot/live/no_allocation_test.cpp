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
#include "robot/live/session/panel_proof.hpp"
#include "robot/live/stage_loop.hpp"
#include "robot/live/supervisor_loop.hpp"
#include "robot/procedure/case/case.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "robot/transport/codec.hpp"
#include "safety/monitors/tissue_monitor.hpp"
#include "safety/supervisor.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/robot/live/realtime/counting_allocator.hpp"
#include "tests/robot/live/steady_host.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

TEST(LiveTick, AllocatesNothingFromSensorToVoltage) {
  const ScratchFolder folder;
  const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), folder.path());
  const Plan& plan = std::get<Plan>(prepared.plan);
  const safety::PlanFacts facts = robot::plan_facts(plan, 1);
  const robot::Rehearsal& given = prepared.given.rehearsal;
  sim::SimulatedStage stage(robot::rehearsed_plant(given.model, given.tissues, prepared.layers, 50.0), 1);
  drivers::GatedStage gated(stage, 1);
  const std::uint64_t tag = planner::plan_tag(plan);
  robot::SupervisorMemory supervisor{.config_tag = 1,
                                     .self_test = safety::SelfTest::Passed,
                                     .plan = facts,
                                     .sealed_tag = tag,
                                     .confirmed_tag = {tag, tag},
                                     .seal = plan.seal,
                                     .state = safety::started(1)};
  robot::ControllerMemory controller{.config_tag = 1};
  robot::load_plan(plan, controller);
  robot::SupervisorSources in;
  in.writers = 1;
  in.files_tag = 1, in.files_read_us = INT64_MAX;
  in.panel = {{.estop_a_closed = true, .estop_b_closed = true}, true};
  robot::assume_tested_panel(supervisor);
  in.act.message.stop = StopCategory::None;
  in.act.message.acquiring = false;
  realtime::LatencyHistogram lateness;
  Permit permit;
  bool moved = false;
  const realtime::AllocationCount allocations;
  for (std::int64_t tick = 1; tick <= 3'000; ++tick) {
    const Measurement measured = gated.measure();
    biopsy_wire_Measurement wire{};
    transport::encode(measured, wire);
    Measurement received;
    transport::decode(wire, received);
    in.now_us = tick * 1'000;
    in.measurement = received;
    in.panel.levels.arm_key = tick > 100;
    in.panel.levels.relay_closed = permit.mode == Mode::Ready || safety::hv_permitted(permit.mode);
    if (tick > 200) in.act.message.token = 1, in.act.message.held = true;
    in.act.at_us = in.log.at_us = in.now_us;
    permit = robot::supervise(in, supervisor).output.permit;
    in.request = robot::control({.measurement = received, .permit = permit, .step = supervisor.state.step},
                                controller);
    robot::actuate({in.request, permit, in.now_us, 1}, gated);
    lateness.record(tick);
    moved = moved || permit.mode == Mode::Active;
  }
  EXPECT_EQ(allocations.so_far(), 0U);
  EXPECT_TRUE(moved);  // or the claim would be about a robot at rest
}

// The loops as they ship, on a bus of this process. The bus is C and takes memory by malloc; what is written
// in C++ takes it by new.
struct Taken {
  std::uint64_t at_rest = 0, later = 0;
  bool moved = false;  // or the claim would be about a robot at rest
  std::string stopped_by;
};

Taken taken_by_the_loops() {
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
  live::FilesTag files;
  live::SupervisorLoop supervisor(bus, pulse, reader, files, 1, 1, safety::SelfTest::Passed, false);
  transport::Writer<SealedPlan> plans(bus);
  transport::Writer<OperatorAct> acts(bus);
  transport::Writer<LogHealth> log(bus);
  transport::Reader<Decision> decisions(bus);
  const std::uint64_t tag = planner::plan_tag(plan);
  plans.write({1, planner::canonical_bytes(plan), plan.seal, {tag, tag}});
  stage.heartbeat().note("a trouble that a person should read, longer than any short string");
  controller.heartbeat().note("a trouble that a person should read, longer than any short string");
  OperatorAct act;
  act.acquiring = false;
  robot::PanelProof person;
  Taken taken;
  for (std::int64_t tick = 1; tick <= 3'000 && !(taken.moved && tick % 500 == 0); ++tick) {
    ++act.seq;
    if (tick > 700) act.token = 1, act.held = true;
    acts.write(act);
    log.write({.seq = act.seq, .backlog_ms = 0, .records = 1});
    const bool closed = supervisor.mode() == Mode::Ready || safety::hv_permitted(supervisor.mode());
    digital_io::PanelLevels levels =
        person.levels({.arm_key = tick > 600, .estop_a_closed = true, .estop_b_closed = true}, {.session = 1},
                      tick * 1'000);
    levels.relay_closed = closed, levels.relay_wired = true;  // no process stands for the relay
    panel.set(levels);
    converter.mark_panel_read(realtime::monotonic_ns());
    files.set(1, realtime::monotonic_ns() / 1000);
    const bool settled = tick > 200;  // a plan is opened at rest, and that takes memory
    const realtime::NewCount count;
    stage.tick(realtime::monotonic_ns() / 1000);
    supervisor.turn();
    controller.turn(std::chrono::milliseconds(1));
    (settled ? taken.later : taken.at_rest) += count.so_far();
    taken.moved = taken.moved || supervisor.mode() == Mode::Active;
    for (Decision decision; decisions.take(decision);)
      if (decision.mode == Mode::Trip)
        taken.stopped_by = safety::name_of(static_cast<safety::Hazard>(decision.reason));
  }
  return taken;
}

TEST(LiveTick, OfTheLoopsTakesNoMemoryBesideTheBus) {
  live_tests::on_a_steady_host([]() -> std::string {
    const Taken taken = taken_by_the_loops();
    EXPECT_EQ(taken.later, 0U);
    EXPECT_GT(taken.at_rest, 0U) << "nothing is counted";
    if (taken.moved) return {};
    return taken.stopped_by.empty() ? std::string(live_tests::kNotInTime) : taken.stopped_by;
  });
}

}  // namespace
}  // namespace biopsy
