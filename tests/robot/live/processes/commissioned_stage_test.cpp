// What a hardware stage must have before a process drives it.
#include "robot/live/processes/commissioned_stage.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/robot/live/loops/fake_bus.hpp"
#include "tests/robot/live/processes/fake_machine.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

struct CommissionedStage : testing::Test {
  CommissionedStage() {
    fake_bus::reset(0);
    fake_machine::state() = {};
    write_content(folder / "board.toml", "abc");
  }
  std::unique_ptr<drivers::HardwareNeedleStage> open() const {
    return open_commissioned_stage("nidaqmx", folder / "board.toml", folder / "record",
                                   folder / "public.pem");
  }
  std::string refusal() const {
    try {
      open();
    } catch (const ConfigError& error) {
      return error.what_is_wrong + " | " + error.where;
    }
    return "";
  }

  const ScratchFolder folder;
  fake_machine::State& machine = fake_machine::state();
};

// SHA-256 of "abc": FIPS 180-2, appendix B.1.
TEST_F(CommissionedStage, IsTheOneThatItsRecordNamesWithThisConfigurationToday) {
  const auto before = std::chrono::system_clock::now();
  EXPECT_EQ(open()->serial(), 4'711U);
  ASSERT_EQ(machine.loaded.size(), 1U);
  const fake_machine::Loaded& record = machine.loaded[0];
  EXPECT_EQ(record.folder, folder / "record");
  EXPECT_EQ(record.public_key, folder / "public.pem");
  EXPECT_EQ(record.device, (commissioning::Device{"nidaqmx", "USB-6211", 4'711}));
  EXPECT_EQ(record.config_sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_GE(record.now, before);
  EXPECT_LE(record.now, std::chrono::system_clock::now());
}

TEST_F(CommissionedStage, IsRefusedWithoutItsRecordItsPanelOrTheRelaysContact) {
  machine.record_is_wrong = "is of another stage";
  EXPECT_EQ(refusal(), "is of another stage | " + (folder / "record").string());
  machine.record_is_wrong.reset();
  machine.board.has_panel = false;
  EXPECT_EQ(refusal(), "no keys and no emergency stop are wired | " + (folder / "board.toml").string());
  machine.board.has_panel = true, machine.board.has_relay_contact = false;
  EXPECT_EQ(refusal(), "the interlock's relay is not read back | " + (folder / "board.toml").string());
}

TEST_F(CommissionedStage, OfALoopWithoutAClockWaitsForEachMillisecond) {
  const auto board = open();
  RealtimeNeedleStage stage(*board);
  EXPECT_EQ(machine.periods, std::vector<std::chrono::nanoseconds>{std::chrono::milliseconds(1)});
  EXPECT_EQ(stage.read().depth_um, 321);
  EXPECT_EQ(stage.read().depth_um, 321);
  EXPECT_EQ(machine.ticks, 2);
  EXPECT_EQ(stage.write(digital_io::high_voltage(3'000'000)), 3'000'000);
  EXPECT_EQ(machine.board.written_mV, std::vector<std::int32_t>{3'000'000});
  EXPECT_EQ(machine.ticks, 2);
}

}  // namespace
}  // namespace biopsy::robot
