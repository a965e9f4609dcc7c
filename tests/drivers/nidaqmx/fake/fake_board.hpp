// A fake board: libnidaqmx.so of the tests, with the vendor's C interface, backed by the simulated plant.
// Tests reach it through these functions.
#pragma once

#include <atomic>
#include <cstdint>

#include "sim/plant/plant.hpp"

namespace biopsy::fake {

// All state, for tests to read and change; what another thread changes is atomic. One board a process, wired
// as in usb6211.toml: laser 1.5 V at rest and 2 mm/V, amplifier 1 kV/V, monitors 1 kV/V and 4 mA/V, pulse on
// port1/line0, enable on port1/line1, keys and contacts on port0.
struct Board {
  sim::PlantModel model;
  sim::PlantState plant;
  std::int64_t now_us = 0;  // 1 ms for each voltage written

  std::atomic<double> output_V = 0.0;            // of the converter
  double highest_V = 0.0;                        // largest |output_V|
  std::uint32_t lines = 0;                       // outputs
  std::atomic<std::uint32_t> contacts = 0b1100;  // inputs: keys up, emergency stop not pressed
  bool has_interlock = true;                     // fitted: the amplifier is on only while it is closed
  std::int64_t interlock_us = 20'000;
  std::int64_t pulse_us = -1'000'000;  // when the driver's pulse last changed
  // The supervisor's half, on a line of another board; closed until its first pulse.
  const char* supervisor_wire = "Dev2/port0/line0";
  std::uint32_t supervisor_line = 0;
  bool has_supervisors_half = true;
  std::int64_t supervisor_us = -1;
  bool supervisor_high = false;

  double laser_noise_V = 0.005;  // 10 um
  double monitor_noise_V = 0.002;
  double laser_zero_V = 1.5, laser_mm_per_V = 2.0;
  double monitor_gain = 1.0, monitor_offset_V = 0.0;
  bool laser_stuck = false;          // the converter repeats its code
  double laser_stuck_V = 0.0;        // set when it sticks
  std::atomic<double> push_N = 0.0;  // on plate A, down

  int press_under_voltage = 0;      // > 0: after so many ticks with voltage the emergency stop is pressed
  std::uint32_t dead_contacts = 0;  // inputs that stay closed

  std::uint32_t serial = 30123456;
  int tasks = 0;  // open now
};

}  // namespace biopsy::fake

extern "C" {
// A new board, at rest. Tasks of the old one are invalid.
biopsy::fake::Board* fake_reset();
biopsy::fake::Board* fake_board();
// The next `times` calls of a function ("DAQmxReadAnalogF64") answer with `status`; -1: all of them.
void fake_fail(const char* function, std::int32_t status, int times);
std::int64_t fake_now_us();
}
