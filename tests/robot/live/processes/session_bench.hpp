// A session's inputs in a folder of the test: programs that a FakeSystem counts, a case, a fake bus.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"
#include "robot/live/session/live_session.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/robot/live/loops/bench.hpp"
#include "tests/robot/live/processes/fake_system.hpp"

namespace biopsy::robot {

namespace fs = std::filesystem;

inline std::string what(const std::function<void()>& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    return error.what_is_wrong + " | " + error.where;
  }
  return "";
}

constexpr std::uint32_t kDomains = 1'000'000;  // those of these tests lie above

struct SessionBench : loops_tests::LoopBench {
  SessionBench() {
    ::setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
    fs::create_directories(folder / "programs");
    for (const char* name :
         {"biopsy-interlock", "biopsy-recorder", "biopsy-supervisor", "biopsy-stage", "biopsy-controller"})
      write_content(folder / (std::string("programs/") + name), "");
    for (const char* name : {"model.toml", "tissues.toml", "faults.toml", "board.toml"})
      write_content(folder / name, name);
    fs::create_directories(folder / "run");
    options.domain = kDomains + static_cast<std::uint32_t>(::getpid());  // no other test's
    sweep();
    options.keys = folder / "keys";
    prepared.given.rehearsal.model = folder / "model.toml";
    prepared.given.rehearsal.tissues = folder / "tissues.toml";
    prepared.given.weight = Grams(31.0);
    prepared.given.seed = 17;
    prepared.layers = {{"skin", Millimetres(0.0), Millimetres(2.0)}};
    hardware = {folder / "board.toml", folder / "commissioned"};
  }
  ~SessionBench() override {
    fs::remove_all(lines());
    ::unsetenv("XDG_CONFIG_HOME");
  }
  // Removes the digital I/O of processes that a mutant ended in the middle of a test.
  static void sweep() {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator("/dev/shm", ignored)) {
      std::uint32_t domain = 0;
      const bool is_found = std::sscanf(entry.path().filename().c_str(), "biopsy-%*u-%u-1", &domain) == 1;
      if (is_found && domain > kDomains && !fs::exists(fmt::format("/proc/{}", domain - kDomains)))
        fs::remove_all(entry.path(), ignored);
    }
  }
  static void make_keys(const fs::path& to) {
    const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
    security::make_keys(to, 1, now, false);
  }
  fs::path lines() const { return fmt::format("/dev/shm/biopsy-{}-{}-1", ::getuid(), options.domain); }
  live::LiveSettings write(const std::string& device = "sim") const {
    return write_run_folder(options, device, hardware, prepared, folder / "run");
  }

  fake_system::FakeSystem system{folder / "programs/biopsy"};
  LiveOptions options;
  HardwareOptions hardware;
  PreparedCase prepared{};
};

}  // namespace biopsy::robot
