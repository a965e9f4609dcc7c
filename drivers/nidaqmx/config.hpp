// Wiring and scales of sensors and amplifier (TOML; docs/how-to/commission-a-stage.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace biopsy::nidaqmx {

constexpr double kBoard_V = 10.0;  // converters of the 6211, in and out

struct AnalogInput {
  std::uint32_t number = 0;      // of ai0, ai1, ...
  std::int32_t terminal = 0;     // kRse or kDiff
  double low_V = 0, high_V = 0;  // range asked of the board
};

struct Laser {
  AnalogInput input;
  double zero_V = 0;                         // at depth 0
  double mm_per_V = 0;                       // negative where the voltage falls as the needle goes deeper
  double valid_low_V = 0, valid_high_V = 0;  // outside: target out of range or too little light
};

struct Monitor {
  AnalogInput input;
  double per_V = 0;  // kV or mA
};

struct Command {
  std::uint32_t number = 0;  // of ao0, ao1
  double kV_per_V = 0;       // the amplifier's gain
  double highest_kV = 0;     // limit of |command|, below the gate's; at most 8 kV
};

// Lines of one port; bit = number of the line.
struct Interlock {
  std::uint32_t port = 0;
  std::uint32_t pulse_line = 0;
  std::optional<std::uint32_t> enable_line;  // high: the amplifier's output may be on
  std::optional<std::uint32_t> brake_line;   // high: the brake holds the needle
};

// Contacts to the port's inputs; high = contact closed.
struct PanelInputs {
  std::uint32_t port = 0;
  std::uint32_t arm_line = 0, reset_line = 0;
  std::uint32_t estop_a_line = 0, estop_b_line = 0;  // closed = not pressed
};

// Feedback contact of the interlock's relay, as a voltage: a board of four inputs has none left for it.
struct RelayContact {
  AnalogInput input;
  double closed_V = 0;  // above: closed
};

// An output of a board of its own, which the supervisor pulses.
struct SupervisorPulse {
  std::string device;  // "Dev2"
  std::uint32_t port = 0, line = 0;
};

struct Config {
  std::string library = "libnidaqmx.so";
  std::string device;                   // "Dev1"
  std::optional<std::uint32_t> serial;  // where given, no other board is accepted
  double timeout_s = 0.002;             // for one call within a tick
  Laser laser;
  std::optional<Laser> second_laser;  // without it only plans for the bench can be run
  Monitor voltage, current;
  Command command;
  Interlock interlock;
  std::optional<PanelInputs> panel;
  std::optional<RelayContact> relay_contact;  // without it only commissioning can be run
  std::optional<SupervisorPulse> supervisor_pulse;
};

// In the order in which the stage reads them: laser, voltage, current, then second laser and relay contact
// where there are any.
std::vector<const AnalogInput*> analog_inputs(const Config& config);

// Throw ConfigError, with file and line, for entries that are missing, unknown, out of range or inconsistent:
// a monitor that cannot show 8.2 kV, a laser that cannot measure 2 mm beyond the stroke.
Config parse_config(const std::string& text, const std::string& name);
Config read_config(const std::filesystem::path& file);

}  // namespace biopsy::nidaqmx
