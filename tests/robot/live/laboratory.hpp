// The laboratory's stage with a board that is not there: the vendor's library of the tests stands in its
// place.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>

#include "drivers/commissioning/load_commissioning.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/procedure/case/case.hpp"
#include "robot/security/key_files.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/robot/bench/commissioning_benches.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::live_tests {

namespace fs = std::filesystem;

inline constexpr std::uint32_t kLabDomain = 85;

struct Lab {
  Lab() {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    options.domain = kLabDomain;
    options.keys = folder.path() / "keys";
    security::make_keys(options.keys, 1, now, false);
    hardware.config = folder.path() / "stage.toml";
    hardware.commissioning = folder.path() / "commissioned";
    std::ofstream(hardware.config) << "library = \"" << FAKE_NIDAQMX << "\"\n"
                                   << file_content(source_dir() / "drivers/nidaqmx/usb6211.toml");
  }

  // As `biopsy commission` does it, every step walked.
  void commission() const {
    commissioning::Laboratory laboratory;
    commissioning::Record record = laboratory.run();
    record.device = {"nidaqmx", laboratory.stage.product(), laboratory.stage.serial()};
    record.config_sha256 = hex(sha256(file_content(hardware.config)));
    record.software = "biopsy of a test";
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    record.made_unix_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
    ASSERT_TRUE(record.passed()) << commissioning::text_of(record);
    const SigningKey key(security::signing_files(options.keys, security::Signer::Commissioning).private_key);
    const std::string text = commissioning::to_json(record);
    fs::create_directories(hardware.commissioning);
    std::ofstream(hardware.commissioning / commissioning::kRecordFile, std::ios::binary) << text;
    std::ofstream(hardware.commissioning / commissioning::kSignatureFile, std::ios::binary)
        << view(key.sign(text));
    // For the processes to come; in this one the board is that of the commissioning.
    setenv("FAKE_NIDAQMX_RELAY", (folder.path() / "relay").c_str(), 1);
  }

  // What starting says; empty where the robot came up.
  std::string refusal() const {
    const ScratchFolder run;
    const robot::PreparedCase prepared = robot::prepare(robot::read_case("gap"), run.path());
    try {
      robot::LiveSession session(options, "nidaqmx", hardware, prepared, run.path());
      session.wait_until_healthy();
      return {};
    } catch (const ConfigError& error) {
      return error.what_is_wrong + file_content(run.path() / "stage.txt") +
             file_content(run.path() / "supervisor.txt");
    }
  }

  ScratchFolder folder;
  robot::LiveOptions options;
  robot::HardwareOptions hardware;
};

}  // namespace biopsy::live_tests
