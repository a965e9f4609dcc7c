// The real processes on the laboratory's stage, whose board is not there: the vendor's library of the tests
// stands in its place, in the stage's process and in the supervisor's.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/commissioning/signature.hpp"
#include "robot/app/case.hpp"
#include "robot/app/live_session.hpp"
#include "robot/keys/key_files.hpp"
#include "robot/keys/make_keys.hpp"
#include "robot/messages/setup_error.hpp"
#include "tests/commissioning/benches.hpp"
#include "tests/live/steady_host.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::live_tests {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kDomain = 85;

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

struct Lab {
  Lab() {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    options.domain = kDomain;
    options.keys = folder.path() / "keys";
    keys::make_keys(options.keys, 1, now, false);
    hardware.config = folder.path() / "stage.toml";
    hardware.commissioning = folder.path() / "commissioned";
    std::ofstream(hardware.config) << "library = \"" << FAKE_NIDAQMX << "\"\n"
                                   << bytes_of(BIOPSY_SOURCE_DIR "/drivers/nidaqmx/usb6211.toml");
  }

  // As `biopsy commission` does it, every step walked.
  void commission() const {
    commissioning::Laboratory laboratory;
    commissioning::Record record = laboratory.walk();
    record.device = {"nidaqmx", laboratory.stage.product(), laboratory.stage.serial()};
    record.config_sha256 = commissioning::sha256_hex(bytes_of(hardware.config));
    record.software = "biopsy of a test";
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    record.made_unix_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
    ASSERT_TRUE(record.passed()) << commissioning::told_all(record);
    const commissioning::SigningKey key(
        keys::signing_files(options.keys, keys::Signer::Commissioning).private_key);
    const std::string text = commissioning::to_json(record);
    fs::create_directories(hardware.commissioning);
    std::ofstream(hardware.commissioning / commissioning::kRecordFile, std::ios::binary) << text;
    std::ofstream(hardware.commissioning / commissioning::kSignatureFile, std::ios::binary) << key.sign(text);
  }

  // What starting says; empty where the robot came up.
  std::string refusal() const {
    const ScratchFolder run;
    const app::PreparedCase prepared = app::prepare(app::read_case("gap"), run.path());
    try {
      app::LiveSession session(options, "nidaqmx", hardware, prepared, run.path());
      session.wait_until_healthy();
      return {};
    } catch (const SetupError& error) {
      return error.what_is_wrong + bytes_of(run.path() / "stage.txt") +
             bytes_of(run.path() / "supervisor.txt");
    }
  }

  ScratchFolder folder;
  app::LiveOptions options;
  app::HardwareOptions hardware;
};

TEST(HardwareLive, ACommissionedStageGetsReadyAndNothingMovesBeforeAHandTurnsTheKey) {
  verifies("R-40");
  const Lab lab;
  lab.commission();
  on_a_steady_host([&]() -> std::string {
    const ScratchFolder run;
    const app::PreparedCase prepared = app::prepare(app::read_case("gap"), run.path());
    app::LiveSession session(lab.options, "nidaqmx", lab.hardware, prepared, run.path());
    session.wait_until_healthy();
    session.send_plan(std::get<Plan>(prepared.plan));
    app::World asking;  // over the network: which arms nothing
    asking.remote_arm = true;
    bool ready = false;
    Measurement seen;
    for (int n = 0; n < 3'000; ++n) {
      const std::optional<app::Beat> beat = session.robot().tick(asking);
      if (!beat) continue;
      ready = ready || beat->tick.supervisor.permit.mode == Mode::Ready;
      seen = beat->tick.measurement;
      EXPECT_FALSE(beat->tick.supervisor.permit.hv_enable);
    }
    EXPECT_TRUE(seen.laser_valid);
    EXPECT_NEAR(seen.depth_um, 0, 100);
    EXPECT_EQ(seen.command_mV, 0);
    session.stop();
    return ready ? "" : "the robot never got ready";
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

TEST(HardwareLive, WithoutALineForItsPulseTheSupervisorDoesNotStart) {
  verifies("R-43");
  const Lab lab;
  std::string text = bytes_of(lab.hardware.config);
  text.erase(text.find("[supervisor_pulse]"));
  std::ofstream(lab.hardware.config) << text;
  EXPECT_NE(lab.refusal().find("half of the interlock"), std::string::npos) << lab.refusal();
}

}  // namespace
}  // namespace biopsy::live_tests
