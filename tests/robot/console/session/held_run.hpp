// OperatorSession without a page and without a robot, for its tests.
#pragma once

#include <gtest/gtest.h>

#include <thread>

#include "robot/console/operator_session.hpp"
#include "robot/procedure/operator.hpp"
#include "robot/procedure/procedure.hpp"
#include "safety/types/transitions.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {

namespace commands = console::commands;
namespace events = console::events;
using console::Mark;

constexpr console::Client kPage = 1;
constexpr std::int64_t kTick_us = 1000;

struct Console {
  ScratchFolder folder;
  OperatorSession session;
  std::vector<std::array<std::uint64_t, 2>> sent;  // the confirmations of each plan that was sent
  std::int64_t now_us = 0;

  explicit Console(const Case& given, bool simulated = true)
      : session(open_case(given, folder / "case"), simulated, folder.path(), 1,
                [this](const Plan&, const std::array<std::uint64_t, 2>& confirmed) {
                  sent.push_back(confirmed);
                }) {
    session.connect(kPage);
  }

  bool send(const console::commands::Any& command) {
    const auto answer = session.handle(kPage, command, now_us);
    return answer && answer->done;
  }
  void receive(Mode mode, safety::Hazard worst) {
    now_us += kTick_us;
    session.inputs(now_us);
    CycleSample cycle{};
    cycle.record.supervisor.permit.mode = mode;
    cycle.record.supervisor.worst = worst;
    session.update(cycle, now_us);
  }
  bool open(const std::string& series_uid) {
    if (!send(commands::OpenSeries{1, series_uid})) return false;
    while (!session.state(kPage, now_us).reading.empty()) {
      std::this_thread::yield();
      receive(Mode::Safe, safety::Hazard::PlanUnconfirmed);
    }
    return session.prepared().image.identity.series_uid == series_uid;
  }
  bool set_point(Mark mark, const Point& p_S) {
    const Volume& image = session.prepared().image;
    const Eigen::Vector3d voxel = image.grid.X_SI.inverse() * p_S;
    const Point ras = ras_from_lps(p_S);
    return send(commands::SetPoint{
        1, mark, image.identity.series_uid, {voxel.x(), voxel.y(), voxel.z()}, {ras.x(), ras.y(), ras.z()}});
  }
  void plan(const Point& p_SE, const Point& p_ST) {
    ASSERT_TRUE(set_point(Mark::Entry, p_SE));
    ASSERT_TRUE(set_point(Mark::Target, p_ST));
    ASSERT_TRUE(send(commands::ConfirmPlan{1, session.planned().seal})) << session.planned().refusal;
  }
  void tick_all(bool on) {
    for (const console::Tick tick : {console::Tick::Patient, console::Tick::Place, console::Tick::Risks})
      ASSERT_TRUE(send(commands::SetTick{1, tick, on, session.planned().seal}));
  }
};

// A run to the end of its only step, where its image begins. The robot is a table of what its supervisor may
// say, in any order, without a supervisor behind it: the console must not rely on that.
struct ArrivedRun {
  Console console;
  safety::Hazard worst = safety::Hazard::None;  // in every tick from here on
  bool disturbed = false;                       // the supervisor calls the image so, likewise

  explicit ArrivedRun(const Case& given = read_case("gap")) : console(given) {
    const Target target = console.session.prepared().target;
    arrives(target.p_SE, target.p_ST);
  }
  ArrivedRun(const Case& given, const Point& p_SE, const Point& p_ST) : console(given) {
    arrives(p_SE, p_ST);
  }
  void arrives(const Point& p_SE, const Point& p_ST) {
    EXPECT_TRUE(console.open(console.session.prepared().image.identity.series_uid));
    console.plan(p_SE, p_ST);
    console.tick_all(true);
    for (const Mode mode : {Mode::Ready, Mode::Armed, Mode::Active, Mode::Hold}) says(mode);
  }
  // Until the image is taken and checked.
  void takes_image() {
    for (int i = 0; i < kFastScan / Seconds(kTick) + 10; ++i) says(Mode::Hold);
    while (state().scanner != console::Scanner::Idle) {
      console.session.wait_for_results();  // of the session's own clock no more than a tick passes
      says(Mode::Hold);
    }
  }
  void says(Mode mode, safety::Hazard reason = safety::Hazard::None,
            safety::Event event = safety::Event::None) {
    console.now_us += kTick_us;
    console.session.inputs(console.now_us);
    CycleSample cycle{};
    cycle.truth.tip_mm = std::get<Plan>(console.session.prepared().plan).target_depth.value;
    cycle.record.supervisor.permit.mode = mode;
    cycle.record.supervisor.worst = worst;
    cycle.record.supervisor.image_disturbed = disturbed;
    cycle.record.supervisor.reason = reason;
    cycle.record.supervisor.event = event;
    cycle.record.supervisor.step_done = mode >= Mode::Hold;
    console.session.update(cycle, console.now_us);
  }
  events::State state() { return console.session.state(kPage, console.now_us); }
  bool accept() { return console.send(commands::Judge{1, 0, console::Judgement::Accept}); }
  bool reject() { return console.send(commands::Judge{1, 0, console::Judgement::Reject}); }
};

// The same with its image checked.
struct HeldRun : ArrivedRun {
  HeldRun() { takes_image(); }
};

}  // namespace biopsy::robot
