// The stages of the stage process: what they show of panel and converter, and how much of the plant's time
// goes by. The relay is the interlock's own, on the virtual clock.
#include "robot/live/processes/io_stages.hpp"

#include "drivers/digital_io/interlock_relay.hpp"
#include "drivers/digital_io/shared_io.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/loops/bench.hpp"

namespace biopsy::loops_tests {
namespace {

// Keeps what was written; gives another number back, as a driver that limited it.
struct WrittenStage final : drivers::NeedleStage {
  std::vector<std::int32_t> written_mV;
  drivers::SensorReading read() override { return {.time_us = 5, .depth_um = 1'234, .brake_fitted = true}; }
  std::int32_t write(const safety::GatedVoltage& voltage) override {
    written_mV.push_back(voltage.mV());
    return -11;
  }
};

struct IoStages : LoopBench {
  void at_us(std::int64_t us) { fake_bus::set_clock_us(kStart_us + us); }
  // Both sides feed the interlock until `us`.
  void close_relay(digital_io::InterlockRelay& relay, std::int64_t us) {
    for (std::int64_t t = us - 10'000; t <= us; t += 1'000) {
      io.pulse(), supervisor.pulse();
      relay.tick((kStart_us + t) * 1'000);
    }
  }

  digital_io::StageIo io{folder.path()};
  digital_io::SupervisorIo supervisor{folder.path()};
  const digital_io::IoReader reader{folder.path()};
  WrittenStage stage;
};

TEST_F(IoStages, EachContactOfAHardwarePanelIsItsOwnLevel) {
  using Contact = std::pair<bool drivers::Panel::*, bool digital_io::PanelLevels::*>;
  for (const auto& [contact, level] :
       {Contact{&drivers::Panel::arm, &digital_io::PanelLevels::arm_key},
        {&drivers::Panel::reset, &digital_io::PanelLevels::reset_key},
        {&drivers::Panel::estop_a_closed, &digital_io::PanelLevels::estop_a_closed},
        {&drivers::Panel::estop_b_closed, &digital_io::PanelLevels::estop_b_closed},
        {&drivers::Panel::relay_closed, &digital_io::PanelLevels::relay_closed}}) {
    drivers::Panel panel;
    panel.*contact = true;
    digital_io::PanelLevels expected{.relay_wired = true};
    expected.*level = true;
    EXPECT_EQ(robot::panel_levels(panel), expected);
  }
  EXPECT_EQ(robot::panel_levels({.read = true}), digital_io::PanelLevels{.relay_wired = true});
}

TEST_F(IoStages, AHardwareStageGetsTheVoltageItselfAndTheConverterShowsIt) {
  robot::MirroredNeedleStage mirrored(stage, io);
  EXPECT_EQ(mirrored.read().depth_um, 1'234);
  EXPECT_EQ(mirrored.write(digital_io::high_voltage(3'000'000)), -11) << "what the driver says";
  EXPECT_EQ(stage.written_mV, std::vector<std::int32_t>{3'000'000});
  EXPECT_EQ(reader.converter().mV, 3'000'000);
  EXPECT_TRUE(reader.converter().hv_enabled);
}

TEST_F(IoStages, ASimulatedStageGetsTheVoltageWhileTheRelayIsClosedAndOtherwiseNone) {
  digital_io::InterlockRelay relay(folder.path(), kStart_us * 1'000);
  robot::SimulatedNeedleStage simulated(stage, io, reader);
  at_us(10'000);
  EXPECT_EQ(simulated.write(digital_io::high_voltage(3'000'000)), 3'000'000);
  EXPECT_EQ(stage.written_mV, std::vector<std::int32_t>{0}) << "the relay is open";
  EXPECT_EQ(reader.converter().mV, 3'000'000);
  close_relay(relay, 11'000);
  at_us(11'000);
  simulated.write(digital_io::high_voltage(3'000'000));
  EXPECT_EQ(stage.written_mV.back(), 3'000'000);
  at_us(60'000);
  simulated.write(digital_io::high_voltage(3'000'000));
  EXPECT_EQ(stage.written_mV.back(), 0) << "the interlock's process stands still";
}

TEST_F(IoStages, ASimulatedStageLivesThroughTheTimeThatWentByUpToFiftyMilliseconds) {
  robot::SimulatedNeedleStage simulated(stage, io, reader);
  std::int64_t us = 0;
  for (const auto& [passed_us, ticks] : {std::pair{0, 1U},  // the first
                                         {1'000, 1U},
                                         {1'400, 1U},
                                         {1'400, 2U},  // 0.8 ms were kept
                                         {7'200, 7U},
                                         {200, 0U},
                                         {500'000, 50U},
                                         {1'000, 1U},
                                         {600, 1U}}) {  // rounded
    stage.written_mV.clear();
    at_us(us += passed_us);
    simulated.write(safety::GatedVoltage::off());
    EXPECT_EQ(stage.written_mV.size(), ticks) << "at " << us;
  }
  at_us(7'000'000);
  const drivers::SensorReading reading = simulated.read();
  EXPECT_EQ(reading.time_us, kStart_us + 7'000'000) << "the machine's clock, not the plant's";
  EXPECT_EQ(reading.depth_um, 1'234);
}

}  // namespace
}  // namespace biopsy::loops_tests
