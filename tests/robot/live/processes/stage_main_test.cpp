// The stage process from main() to its end: the simulated plant in real time and what is told of its truth;
// a board with its panel and its errors; 0 V at the end. The gate puts out what the test wants.
#include <cmath>
#include <set>

#include "drivers/digital_io/interlock_relay.hpp"
#include "robot/procedure/rehearsed_plant.hpp"
#include "sim/faults/fault_file.hpp"
#include "sim/faults/faulty_stage.hpp"
#include "sim/simulated_stage.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/processes/process_bench.hpp"

namespace biopsy::processes_tests {
namespace {

using std::chrono::milliseconds;

struct StageMain : ProcessBench {
  // Before each tick the relay is fed by both sides, so that amplifier and brake are supplied.
  void for_ticks(int most, std::function<void(int)> before = {}) {
    machine.on_tick = [this, most, before](int tick) {
      const std::int64_t now_ns = fake_bus::state().now_ns;
      relay.write({.load_mV = 0, .closed = true}, now_ns);
      systemd.receive();
      if (before) before(tick);
      if (tick == most) stop();
    };
  }
  void put_out(std::int32_t mV) const {
    calls.voltage = mV == 0 ? safety::GatedVoltage::off() : digital_io::high_voltage(mV);
  }
  // The same plant, driven by the test.
  sim::SimulatedStage twin() const {
    return {robot::rehearsed_plant(settings.model, settings.tissues, settings.layers, settings.weight_g),
            settings.seed};
  }

  digital_io::InterlockIo relay{folder.path()};
  const digital_io::IoReader reader{folder.path()};
};

struct SimulatedStageMain : StageMain {};

TEST_F(SimulatedStageMain, TicksEveryMillisecondAndTellsTheTruthOfItsPlant) {
  settings.weight_g = 40.0;
  constexpr std::int32_t kDrive_mV = 4'000'000;
  constexpr int kTicks = 300;
  for_ticks(kTicks, [&](int tick) { put_out(tick <= 2 ? 0 : kDrive_mV); });
  EXPECT_EQ(run(stage_main), 0);
  EXPECT_EQ(machine.periods, std::vector<std::chrono::nanoseconds>{milliseconds(1)});
  EXPECT_EQ(systemd.notices(), (Notices{"READY=1", "STOPPING=1"}));
  EXPECT_NE(log("stage").find("stage      started"), std::string::npos);
  const auto truths = fake_bus::written<StageTruth>();
  ASSERT_EQ(truths.size(), static_cast<std::size_t>(kTicks));
  sim::SimulatedStage plant = twin();
  for (std::size_t i = 0; i < truths.size(); ++i) {
    plant.put_out(i < 2 ? 0.0 : kDrive_mV * 1e-3);
    EXPECT_EQ(truths[i].seq, i + 1);
    EXPECT_EQ(truths[i].tip_nm, std::lround(plant.truth().motion.x * 1e9)) << i;
    EXPECT_EQ(truths[i].plate_b_nm, std::lround(sim::plate_b(plant.model(), plant.truth()) * 1e9)) << i;
    EXPECT_EQ(truths[i].layers_entered, sim::layers_entered(plant.model(), plant.truth())) << i;
    EXPECT_EQ(truths[i].active_faults, 0U);
  }
  EXPECT_GT(truths.back().tip_nm, 100'000) << "it moved";
  EXPECT_NE(truths.back().tip_nm, truths.back().plate_b_nm);
}

TEST_F(SimulatedStageMain, MovesOnlyWhileTheRelayIsClosed) {
  for_ticks(100, [&](int) {
    relay.write({.load_mV = 0, .closed = false}, fake_bus::state().now_ns);
    put_out(4'000'000);
  });
  run(stage_main);
  for (const StageTruth& truth : fake_bus::written<StageTruth>()) EXPECT_LT(std::abs(truth.tip_nm), 20'000);
}

// Of a simulated panel: its levels are the console's, read in every tick.
TEST_F(SimulatedStageMain, MarksThePanelAsRead) {
  std::vector<bool> read;
  for_ticks(5, [&](int) { read.push_back(reader.panel(fake_bus::state().now_ns).read); });
  run(stage_main);
  EXPECT_EQ(read, (std::vector<bool>{false, true, true, true, true}));
}

TEST_F(SimulatedStageMain, SwitchesOffAtItsEndWhateverWasPermitted) {
  for_ticks(3, [](int) {
    Permit permit;
    permit.seq = 1;
    fake_bus::put(permit);
  });
  run(stage_main);
  ASSERT_EQ(calls.driven.size(), 4U);
  EXPECT_TRUE(calls.driven[2].permit);
  EXPECT_FALSE(calls.driven[3].permit);
  EXPECT_EQ(calls.driven[3].writers, 0);
  EXPECT_EQ(calls.driven[2].now_us, kStart_us + 3'000) << "when the tick began";
  EXPECT_EQ(calls.driven[3].now_us, kStart_us + 3'000);
}

TEST_F(SimulatedStageMain, PutsFaultsOfTheFileIntoIt) {
  settings.faults = folder / "faults.toml";
  write_content(settings.faults,
                "[[fault]]\nsignal = \"depth\"\nkind = \"offset\"\nvalue = 1.0\nfrom_s = 0.01\n"
                "[[fault]]\nsignal = \"depth\"\nkind = \"offset\"\nvalue = 1.0\nfrom_s = 0.02\n");
  for_ticks(60, [&](int) { put_out(1'000'000); });
  run(stage_main);
  sim::SimulatedStage sound = twin();
  sim::FaultyStage faulty(sound, sim::read_faults(settings.faults), settings.seed);
  const auto truths = fake_bus::written<StageTruth>();
  ASSERT_EQ(truths.size(), 60U);
  std::set<std::uint32_t> seen;
  for (const StageTruth& truth : truths) {
    faulty.write(digital_io::high_voltage(1'000'000));
    faulty.read();
    EXPECT_EQ(truth.active_faults, faulty.active_faults()) << truth.seq;
    seen.insert(truth.active_faults);
  }
  EXPECT_EQ(seen, (std::set<std::uint32_t>{0, 1, 3}));
}

// What friction holds out a person draws back, three seconds after the voltage went off; not while it is on.
TEST_F(SimulatedStageMain, APersonDrawsTheNeedleBackWhenHighVoltageIsOff) {
  constexpr int kUp = 3'500, kAll = 7'500;
  for_ticks(kAll, [&](int tick) { put_out(tick <= kUp ? 5'000'000 : 0); });
  run(stage_main);
  const auto truths = fake_bus::written<StageTruth>();
  ASSERT_EQ(truths.size(), static_cast<std::size_t>(kAll));
  sim::SimulatedStage plant = twin();
  for (int tick = 1; tick <= kUp; ++tick) plant.put_out(5'000.0);
  EXPECT_EQ(truths[kUp - 1].tip_nm, std::lround(plant.truth().motion.x * 1e9));
  EXPECT_GT(truths[kUp - 1].tip_nm, 100'000);
  EXPECT_LE(truths.back().tip_nm, 25'000);
}

TEST_F(SimulatedStageMain, ReportsHowLateItIsAndWhatItMissed) {
  with_watchdog(50'000);
  for_ticks(250, [this](int tick) {
    machine.late_ns = 40'000;
    if (tick == 20) machine.missed = 3;
  });
  run(stage_main);
  const auto told = fake_bus::written<Health>();
  ASSERT_GE(told.size(), 2U);
  EXPECT_EQ(told.back().process, Process::Stage);
  EXPECT_EQ(told.back().overruns, 3U);
  EXPECT_EQ(told.back().late_p50_us, 40);
  EXPECT_EQ(told.back().late_max_us, 40);
  EXPECT_EQ(told.back().config_tag, tag());
  EXPECT_NE(log("stage").find("periods missed: 3, since the start 3"), std::string::npos) << log("stage");
  EXPECT_EQ(strokes(), 11);
}

struct HardwareStageMain : StageMain {
  HardwareStageMain() {
    settings.device = "nidaqmx";
    settings.device_config = folder / "board.toml";
    settings.commissioning = folder / "commissioned";
    settings.commissioning_key = folder / "public.pem";
    write_content(folder / "board.toml", "board");
    machine.board.panel.read = true;
  }
};

TEST_F(HardwareStageMain, DrivesTheBoardThatItsCommissioningRecordIsOf) {
  for_ticks(3, [&](int) { put_out(2'000'000); });
  EXPECT_EQ(run(stage_main), 0);
  EXPECT_EQ(machine.board.opened, std::vector<std::string>{"stage nidaqmx board.toml"});
  ASSERT_EQ(machine.loaded.size(), 1U);
  EXPECT_EQ(machine.loaded[0].folder, folder / "commissioned");
  EXPECT_EQ(machine.loaded[0].public_key, folder / "public.pem");
  EXPECT_EQ(machine.board.written_mV,
            (std::vector<std::int32_t>{2'000'000, 2'000'000, 2'000'000, 2'000'000}));
  EXPECT_EQ(reader.converter().mV, 2'000'000) << "and the digital I/O shows it";
  EXPECT_EQ(fake_bus::written<Measurement>().back().depth_um, 321);
  EXPECT_TRUE(fake_bus::written<StageTruth>().empty()) << "nobody knows it";
}

TEST_F(HardwareStageMain, ShowsTheKeysOfTheBoardAndThatTheyWereRead) {
  machine.board.panel = {.arm = true, .estop_b_closed = true, .read = true};
  digital_io::PanelReading seen;
  for_ticks(3, [&](int tick) {
    if (tick == 3) seen = reader.panel(fake_bus::state().now_ns);
  });
  run(stage_main);
  EXPECT_TRUE(seen.read);
  EXPECT_TRUE(seen.levels.arm_key);
  EXPECT_TRUE(seen.levels.estop_b_closed);
  EXPECT_FALSE(seen.levels.estop_a_closed);
}

TEST_F(HardwareStageMain, KeysThatCouldNotBeReadAreNotMarkedAsRead) {
  machine.board.panel = {.arm = true, .read = false};
  digital_io::PanelReading seen;
  for_ticks(3, [&](int tick) {
    if (tick == 3) seen = reader.panel(fake_bus::state().now_ns);
  });
  run(stage_main);
  EXPECT_FALSE(seen.read);
}

// A process that stood still between reading the keys and saying so.
TEST_F(HardwareStageMain, KeysAreAsOldAsTheirReading) {
  machine.board.panel = {.arm = true, .estop_b_closed = true, .read = true};
  digital_io::PanelReading before, after;
  for_ticks(4, [&](int tick) {
    if (tick == 3) before = reader.panel(fake_bus::state().now_ns), machine.board.stands_ns = 30'000'000;
    if (tick == 4) after = reader.panel(fake_bus::state().now_ns);
  });
  run(stage_main);
  EXPECT_TRUE(before.read);
  EXPECT_FALSE(after.read);
  EXPECT_GE(after.age_us, 30'000);
}

TEST_F(HardwareStageMain, LogsEachErrorOfTheDriverOnceAndShowsTheNewest) {
  for_ticks(250, [this](int tick) {
    if (tick != 5 && tick != 150) return;
    machine.board.error.status = tick == 5 ? -200'279 : -50'103;
    machine.board.error.count += tick == 5 ? 1 : 2;
    std::strcpy(machine.board.error.text.data(), tick == 5 ? "too slow" : "gone");
  });
  run(stage_main);
  const std::string text = log("stage");
  EXPECT_EQ(lines_with(text, " warning stage      the stage's driver reports error"), 2) << text;
  EXPECT_EQ(lines_with(text, "error -200279; errors so far: 1"), 1);
  EXPECT_EQ(lines_with(text, "error -50103; errors so far: 3"), 1);
  const auto told = fake_bus::written<Health>();
  ASSERT_GE(told.size(), 3U);
  EXPECT_EQ(told[0].note, "");
  EXPECT_EQ(told[1].note, "too slow");
  EXPECT_EQ(told.back().note, "gone");
}

TEST_F(HardwareStageMain, WithoutAnErrorNothingIsSaid) {
  std::strcpy(machine.board.error.text.data(), "left over");
  for_ticks(250);
  run(stage_main);
  EXPECT_EQ(log("stage").find("reports error"), std::string::npos);
  for (const Health& told : fake_bus::written<Health>()) EXPECT_EQ(told.note, "");
}

TEST_F(HardwareStageMain, DoesNotStartWithoutItsCommissioningRecord) {
  machine.record_is_wrong = "made for another stage";
  testing::internal::CaptureStderr();
  EXPECT_EQ(run(stage_main), 2);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("made for another stage"), std::string::npos);
  EXPECT_EQ(machine.ticks, 0);
}

}  // namespace
}  // namespace biopsy::processes_tests
