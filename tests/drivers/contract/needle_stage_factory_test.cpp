// The stage devices that can be named.
#include "drivers/needle_stage_factory.hpp"

#include <gtest/gtest.h>

#include "tests/drivers/nidaqmx/fake_board_config.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::drivers {
namespace {

TEST(NeedleStageFactory, OpensEveryDeviceButTheSimulatedOneByItsName) {
  fake_reset();
  const ScratchFolder folder;
  folder.write("stage.toml", "library = \"" FAKE_NIDAQMX "\"\n" +
                                 file_content(source_dir() / "drivers/nidaqmx/usb6211.toml"));
  for (const std::string_view name : kStageDevices) {
    const std::string device(name);
    EXPECT_NO_THROW(check_stage_device(device, "--device"));
    if (is_simulated(device)) {
      EXPECT_THROW(make_hardware_stage(device, folder / "stage.toml"), ConfigError);
      continue;
    }
    const auto stage = make_hardware_stage(device, folder / "stage.toml");
    EXPECT_FALSE(stage->product().empty());
    EXPECT_GT(stage->serial(), 0U);
    EXPECT_FALSE(make_supervisor_pulse(device, folder / "stage.toml")->failed());
  }
}

TEST(NeedleStageFactory, RefusesOtherNamesAndListsThose) {
  try {
    check_stage_device("nidaq", "--device");
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, "--device");
    EXPECT_EQ(error.remedy, "choose from sim, nidaqmx");
  }
}

}  // namespace
}  // namespace biopsy::drivers
