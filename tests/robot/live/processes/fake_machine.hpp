// What the processes of the live robot find on a machine, linked in place of the machine's: the tick clock,
// what the kernel grants, the self-test, the laboratory's board and its commissioning record.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/hardware_needle_stage.hpp"
#include "robot/live/realtime/become_realtime.hpp"
#include "safety/types/supervisor_inputs.hpp"

namespace biopsy::fake_machine {

struct Board {  // as its driver shows it
  bool has_panel = true, has_relay_contact = true;
  drivers::Panel panel;
  drivers::DeviceError error;
  std::int64_t stands_ns = 0;  // how long its process stands still after the next reading
  bool pulse_failed = false;
  int pulses = 0;                        // of the supervisor's line
  std::vector<std::int32_t> written_mV;  // to the stage
  std::vector<std::string> opened;       // "stage nidaqmx FILE", "pulse nidaqmx FILE"
};

struct Loaded {  // commissioning record
  std::filesystem::path folder, public_key;
  commissioning::Device device;
  std::string config_sha256;
  std::chrono::system_clock::time_point now;
};

struct State {
  // Before the clock's n-th tick, from 1; it may set how late that is and how many before it were missed.
  std::function<void(int)> on_tick;
  std::int64_t late_ns = 0, missed = 0;
  int ticks = 0;
  std::vector<std::chrono::nanoseconds> periods;  // of the clocks that were made

  std::vector<realtime::RealtimeSettings> asked;  // of the kernel
  realtime::RealtimeObtained granted;
  safety::SelfTest self_test = safety::SelfTest::Passed;
  Board board;
  std::vector<Loaded> loaded;
  std::optional<std::string> record_is_wrong;
};
State& state();

}  // namespace biopsy::fake_machine
