// Every built-in case and a patient's case, rehearsed on the virtual clock and from the console's commands
// (live: tests/robot/live). Their plans have one image, two and three; images are taken again after a
// rejection and in a folder that has been used before.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "planner/plan/seal.hpp"
#include "robot/console/operator_session.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/cycle/simulated_robot.hpp"
#include "robot/procedure/case/case.hpp"
#include "robot/procedure/rehearsal.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/robot/procedure/matrix_cases.hpp"

namespace biopsy::robot {
namespace {

namespace commands = console::commands;
using console::Button;

TEST(ProcedureCases, AreAllInTheMatrix) {
  for (const std::string& name : built_in_cases()) EXPECT_TRUE(kImages.contains(name)) << name;
}

class ProcedureMatrix : public testing::TestWithParam<std::pair<const std::string, int>> {};

TEST_P(ProcedureMatrix, CompletesADryRunTwiceInOneFolder) {
  const ScratchFolder folder;
  for (int run = 1; run <= 2; ++run) {
    const auto answer =
        cli_tests::biopsy("dry-run " + case_file(GetParam().first) + " --out " + (folder / "out").string());
    ASSERT_EQ(answer.code, 0) << answer.text;
    EXPECT_EQ(folders_in(folder / "out/images"), static_cast<std::size_t>(GetParam().second))
        << "run " << run;
  }
}

// The console's commands against the simulated robot on a virtual clock: what a page would send, tick by
// tick.
class ConsoleOperator {
 public:
  explicit ConsoleOperator(const std::string& name)
      : session_(open_case(read_case(case_file(name)), folder_ / "case"), true, folder_.path(), 1,
                 [this](const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
                   send(plan, confirmed);
                 }) {
    session_.connect(kPage);
    tick();
  }

  // One procedure, from the points to the retracted needle; the image of step `rejected` is rejected, if it
  // is one.
  void run(std::optional<std::uint32_t> rejected) {
    const Target target = session_.prepared().target;
    ASSERT_TRUE(command(commands::OpenSeries{1, target.series_uid}));
    while (!session_.state(kPage, now_us_).reading.empty()) std::this_thread::yield(), tick();
    set_point(console::Mark::Entry, target.p_SE);
    set_point(console::Mark::Target, target.p_ST);
    ASSERT_TRUE(command(commands::ConfirmPlan{1, session_.planned().seal})) << session_.planned().refusal;
    insert(rejected);
  }

  void insert(std::optional<std::uint32_t> rejected) {
    for (const console::Tick check : {console::Tick::Patient, console::Tick::Place, console::Tick::Risks})
      ASSERT_TRUE(command(commands::SetTick{1, check, true, session_.planned().seal}));
    ASSERT_TRUE(ticks_until([&] { return mode() == Mode::Ready; }, 1'000));
    hold(Button::Arm, [&] { return mode() == Mode::Armed; });
    for (std::uint32_t step = 0; step < plan_->steps.size(); ++step) {
      hold(Button::Insert, [&] {
        return seen_.supervisor.step == step && seen_.supervisor.step_done && mode() == Mode::Hold;
      });
      if (testing::Test::HasFatalFailure()) return;
      if (!plan_->steps[step].image_confirms) continue;
      wait_for_check(step);
      const bool accept = rejected != step;
      ASSERT_TRUE(command(
          commands::Judge{1, step, accept ? console::Judgement::Accept : console::Judgement::Reject}));
      ++judged_;
      if (!accept) break;
    }
    command(commands::Retract{1});
    wait_for_report();
  }

  int judged() const { return judged_; }
  bool completed() { return session_.state(kPage, now_us_).completed; }
  std::size_t image_folders(int run) const {
    return folders_in(folder_ / ("run-" + std::to_string(run)) / "images");
  }

 private:
  static constexpr console::Client kPage = 1;

  bool command(const commands::Any& given) {
    const auto answer = session_.handle(kPage, given, now_us_);
    return answer && answer->done;
  }
  void set_point(console::Mark mark, const Point& there) {
    const Volume& image = session_.prepared().image;
    const Eigen::Vector3d voxel = image.grid.X_SI.inverse() * there;
    const Point ras = ras_from_lps(there);
    ASSERT_TRUE(command(commands::SetPoint{
        1, mark, image.identity.series_uid, {voxel.x(), voxel.y(), voxel.z()}, {ras.x(), ras.y(), ras.z()}}));
  }
  // Confirmed twice, the plan goes to a robot of its own; before and after there is none to speak of.
  void send(const Plan& plan, const std::array<std::uint64_t, 2>& confirmed) {
    robot_.reset();
    seen_ = {};
    if (confirmed[0] == 0 || confirmed[0] != confirmed[1]) return;
    plan_ = plan;
    facts_ = plan_facts(plan, 7);
    const PreparedCase& prepared = session_.prepared();
    const Case& given = prepared.given;
    stage_ = std::make_unique<sim::SimulatedStage>(
        rehearsed_plant(given.rehearsal.model, given.rehearsal.tissues, prepared.layers, given.weight.value),
        given.seed);
    robot_ = std::make_unique<SimulatedRobot>(*plan_, facts_, *stage_, confirmed);
  }
  Mode mode() const { return seen_.supervisor.permit.mode; }

  void tick() {
    now_us_ += 1'000;
    const OperatorInputs inputs = session_.inputs(now_us_);
    CycleSample cycle;
    if (robot_) {
      cycle.truth.tip_mm = stage_->truth().motion.x * 1e3;
      cycle.record = robot_->run_cycle(inputs);
    }
    seen_ = cycle.record;
    session_.update(cycle, now_us_);
  }
  bool ticks_until(const std::function<bool()>& reached, int most) {
    for (int i = 0; i < most; ++i) {
      if (reached()) return true;
      tick();
      if (i % 100 == 0) session_.state(kPage, now_us_);  // pages are served; reports end here
    }
    return reached();
  }
  // A button held with its heartbeats, then released. Released by the robot's step is a press that must come
  // again.
  void hold(Button button, const std::function<bool()>& reached) {
    for (int press = 0; press < 10 && !reached(); ++press) {
      const std::uint32_t token = session_.state(kPage, now_us_).token;
      ASSERT_TRUE(command(commands::Press{1, button, token, static_cast<double>(now_us_) * 1e-3}))
          << session_.state(kPage, now_us_).disabled.insert << " " << safety::name_of(mode()) << ": "
          << safety::name_of(seen_.supervisor.reason);
      bool moved = false;
      for (int i = 0; i < 60'000 && !reached(); ++i) {
        if (i % 25 == 24) command(commands::Beat{token, static_cast<double>(now_us_) * 1e-3});
        tick();
        moved = moved || mode() == Mode::Active;
        if (moved && mode() == Mode::Hold) break;
      }
      command(commands::Release{token});
      for (int i = 0; i < 50; ++i) tick();
    }
    ASSERT_TRUE(reached()) << safety::name_of(mode()) << ": " << safety::name_of(seen_.supervisor.reason);
  }
  // Reports and checks are made by threads of their own: virtual time waits for them.
  void wait_for_report() {
    for (int i = 0; i < 5'000; ++i) tick();
    session_.wait_for_results();
    session_.state(kPage, now_us_);
    ASSERT_FALSE(session_.report().empty());
  }
  void wait_for_check(std::uint32_t stage) {
    const auto scanner = [&] { return session_.state(kPage, now_us_).scanner; };
    ASSERT_TRUE(ticks_until([&] { return scanner() == console::Scanner::Checking; }, 35'000))
        << "stage " << stage;
    session_.wait_for_results();
    tick();
  }

  ScratchFolder folder_;
  std::optional<Plan> plan_;
  safety::PlanFacts facts_;
  std::unique_ptr<sim::SimulatedStage> stage_;
  std::unique_ptr<SimulatedRobot> robot_;
  CycleRecord seen_;
  std::int64_t now_us_ = 0;
  int judged_ = 0;
  OperatorSession session_;
};

TEST_P(ProcedureMatrix, CompletesFromTheConsole) {
  ConsoleOperator console(GetParam().first);
  console.run(std::nullopt);
  EXPECT_EQ(console.judged(), GetParam().second);
  EXPECT_TRUE(console.completed());
  EXPECT_EQ(console.image_folders(1), static_cast<std::size_t>(GetParam().second));
}

TEST_P(ProcedureMatrix, TakesARejectedImageAgainInTheNextRun) {
  ConsoleOperator console(GetParam().first);
  console.run(GetParam().first == kPatientsCase ? 2U : 0U);  // the first step with an image
  EXPECT_FALSE(console.completed());
  console.insert(std::nullopt);
  EXPECT_TRUE(console.completed());
  EXPECT_EQ(console.judged(), GetParam().second + 1);
  EXPECT_EQ(console.image_folders(2), static_cast<std::size_t>(GetParam().second));
}

INSTANTIATE_TEST_SUITE_P(Cases, ProcedureMatrix, testing::ValuesIn(kImages), [](const auto& given) {
  return given.param.first == kPatientsCase ? "patient" : given.param.first;
});

}  // namespace
}  // namespace biopsy::robot
