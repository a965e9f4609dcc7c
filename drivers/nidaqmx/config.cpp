#include "drivers/nidaqmx/config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <set>

#include "drivers/nidaqmx/daqmx_functions.hpp"
#include "robot/common/files/toml_reader.hpp"
#include "safety/types/limits.hpp"

namespace biopsy::nidaqmx {
namespace {

constexpr std::uint32_t kPair = 8;  // a differential input is this and the one so many higher
constexpr std::uint32_t kInputs = 15, kOutputs = 1, kPorts = 1, kLines = 3;  // highest numbers on the 6211
constexpr std::uint32_t kSupervisorPorts = 15, kSupervisorLines = 31;        // of boards of any kind
constexpr double kMost_kV = limits::kDriveMax_mV * 1e-6;
constexpr double kTrip_kV = limits::kMonitorTrip_mV * 1e-6;
// The arc detector's margin is 1 mA beyond what the capacitance draws: twice that must be visible.
constexpr double kVisible_mA = 2.0;
// From a millimetre below rest to where the supervisor stops hard.
constexpr double kShallow_mm = -1.0, kDeep_mm = (limits::kStroke_um + limits::kDepthHard_um) * 1e-3;

std::string device_text(TomlTable& table, std::string_view name) {
  constexpr std::size_t kLongest = 255;
  const std::string value = table.text(name);
  if (value.empty() || value.size() > kLongest)
    table.refuse(name, "is not a name", fmt::format("write {} = \"...\"", name));
  return value;
}

// A text of the form PREFIX followed by a whole number of at most `high`: "ai0", "port1".
std::uint32_t numbered(TomlTable& table, std::string_view name, std::string_view prefix, std::uint32_t high) {
  const std::string value = device_text(table, name);
  std::uint32_t number = 0;
  const char* const first = value.data() + std::min(prefix.size(), value.size());
  const char* const last = value.data() + value.size();
  const auto [end, error] = std::from_chars(first, last, number);
  if (!value.starts_with(prefix) || error != std::errc() || end != last || number > high)
    table.refuse(name, fmt::format("= \"{}\" is none of {}0 to {}{}", value, prefix, prefix, high),
                 "give the name that stands on the board, without the device");
  return number;
}

AnalogInput read_input(TomlTable& table) {
  AnalogInput input;
  input.number = numbered(table, "channel", "ai", kInputs);
  const std::string terminal = device_text(table, "terminal");
  if (terminal != "RSE" && terminal != "Diff")
    table.refuse("terminal", fmt::format("= \"{}\" is neither RSE nor Diff", terminal),
                 "RSE: against ground; Diff: against the channel eight higher");
  input.terminal = terminal == "RSE" ? kRse : kDiff;
  if (input.terminal == kDiff && input.number >= kPair)
    table.refuse("channel", "has no partner for Diff", "use ai0 to ai7");
  input.low_V = table.number("low_V", -kBoard_V, kBoard_V, "V");
  input.high_V = table.number("high_V", -kBoard_V, kBoard_V, "V");
  if (input.low_V >= input.high_V) table.refuse("high_V", "is not above `low_V`", "give low_V < high_V");
  return input;
}

Laser read_laser(TomlTable table) {
  Laser laser;
  laser.input = read_input(table);
  laser.zero_V = table.number("zero_V", laser.input.low_V, laser.input.high_V, "V");
  laser.mm_per_V = table.number("mm_per_V", -100.0, 100.0, "mm/V");
  if (std::abs(laser.mm_per_V) < 0.01)
    table.refuse("mm_per_V", "is zero", "take it from the laser's data sheet");
  laser.valid_low_V = table.number("valid_low_V", laser.input.low_V, laser.input.high_V, "V");
  laser.valid_high_V = table.number("valid_high_V", laser.input.low_V, laser.input.high_V, "V");
  for (const double depth_mm : {kShallow_mm, kDeep_mm}) {
    const double volts = laser.zero_V + depth_mm / laser.mm_per_V;
    if (volts < laser.valid_low_V || volts > laser.valid_high_V)
      table.refuse(
          "zero_V",
          fmt::format("puts a needle at {:.0f} mm, {:.2f} V, outside what counts as valid", depth_mm, volts),
          "mount the laser so that it sees the whole stroke and 2 mm more");
  }
  return laser;
}

// `unit` of what is monitored; `visible`: how much of it, of either sign, the range must be able to show.
Monitor read_monitor(TomlTable table, const std::string& unit, double visible) {
  Monitor monitor;
  monitor.input = read_input(table);
  const std::string scale = unit + "_per_V";
  monitor.per_V = table.number(scale, 0.01, 100.0, unit + "/V");
  if (std::min(-monitor.input.low_V, monitor.input.high_V) * monitor.per_V < visible)
    table.refuse(scale, fmt::format("and the range cannot show {} {} of either sign", visible, unit),
                 "widen low_V and high_V, or correct the scale");
  return monitor;
}

Command read_command(TomlTable table) {
  Command command;
  command.number = numbered(table, "channel", "ao", kOutputs);
  command.kV_per_V = table.number("kV_per_V", 0.1, 10.0, "kV/V");
  command.highest_kV = table.number("highest_kV", 0.1, kMost_kV, "kV");
  if (command.highest_kV / command.kV_per_V > kBoard_V)
    table.refuse("highest_kV", "needs more than the board's 10 V", "lower it");
  return command;
}

Interlock read_interlock(TomlTable table) {
  Interlock interlock;
  interlock.port = numbered(table, "port", "port", kPorts);
  interlock.pulse_line = numbered(table, "pulse", "line", kLines);
  if (table.has("enable")) interlock.enable_line = numbered(table, "enable", "line", kLines);
  if (interlock.enable_line == interlock.pulse_line)
    table.refuse("enable", "is the line of the pulse", "give each its own line");
  if (table.has("brake")) interlock.brake_line = numbered(table, "brake", "line", kLines);
  if (interlock.brake_line &&
      (interlock.brake_line == interlock.pulse_line || interlock.brake_line == interlock.enable_line))
    table.refuse("brake", "is the line of another output", "give each its own line");
  return interlock;
}

PanelInputs read_panel(TomlTable table) {
  PanelInputs panel;
  panel.port = numbered(table, "port", "port", kPorts);
  std::uint32_t used = 0;
  const auto line = [&](std::string_view name) {
    const std::uint32_t number = numbered(table, name, "line", kLines);
    if ((used >> number & 1U) != 0) table.refuse(name, "is used twice", "give each contact its own line");
    used |= 1U << number;
    return number;
  };
  panel.arm_line = line("arm_key");
  panel.reset_line = line("reset_key");
  panel.estop_a_line = line("estop_a");
  panel.estop_b_line = line("estop_b");
  return panel;
}

RelayContact read_relay_contact(TomlTable table) {
  RelayContact contact;
  contact.input = read_input(table);
  contact.closed_V = table.number("closed_V", contact.input.low_V, contact.input.high_V, "V");
  if (contact.closed_V <= 0.0)
    table.refuse("closed_V", "counts an open wire as closed",
                 "give a voltage between 0 V and the contact's supply");
  return contact;
}

// The name alone, as MAX and nilsdev show it.
std::string read_device(TomlTable& table) {
  std::string device = device_text(table, "device");
  if (device.find_first_of("/, :") != std::string::npos)
    table.refuse("device", "is not one device", "give the name alone, like \"Dev1\"");
  return device;
}

SupervisorPulse read_supervisor_pulse(TomlTable table, const std::string& stage) {
  SupervisorPulse pulse;
  pulse.device = read_device(table);
  if (pulse.device == stage)
    table.refuse("device", "is the stage's board",
                 "use a second board: what fails with the first must not feed both halves of the interlock");
  pulse.port = numbered(table, "port", "port", kSupervisorPorts);
  pulse.line = numbered(table, "pulse", "line", kSupervisorLines);
  return pulse;
}

void refuse_shared_inputs(const Config& config, const TomlTable& root) {
  std::set<std::uint32_t> used;
  for (const AnalogInput* input : analog_inputs(config)) {
    const std::uint32_t last = input->terminal == kDiff ? input->number + kPair : input->number;
    for (std::uint32_t pin = input->number; pin <= last; pin += kPair)
      if (!used.insert(pin).second)
        root.refuse("device", fmt::format("has ai{} connected twice", pin),
                    "give each signal its own inputs; Diff takes two, eight apart");
  }
}

Config read(TomlTable& root) {
  Config config;
  if (root.has("library")) config.library = device_text(root, "library");
  config.device = read_device(root);
  if (root.has("serial"))
    config.serial = root.whole_number("serial", std::numeric_limits<std::uint32_t>::max());
  if (root.has("timeout_ms")) config.timeout_s = root.number("timeout_ms", 0.1, 20.0, "ms") * 1e-3;
  config.laser = read_laser(root.table("laser"));
  if (root.has("second_laser")) config.second_laser = read_laser(root.table("second_laser"));
  config.voltage = read_monitor(root.table("voltage_monitor"), "kV", kTrip_kV);
  config.current = read_monitor(root.table("current_monitor"), "mA", kVisible_mA);
  config.command = read_command(root.table("command"));
  config.interlock = read_interlock(root.table("interlock"));
  if (root.has("panel")) config.panel = read_panel(root.table("panel"));
  if (config.panel && config.panel->port == config.interlock.port)
    root.refuse("panel", "uses the port of the interlock", "inputs are port0 and outputs port1 on the 6211");
  if (root.has("relay_contact")) config.relay_contact = read_relay_contact(root.table("relay_contact"));
  if (root.has("supervisor_pulse"))
    config.supervisor_pulse = read_supervisor_pulse(root.table("supervisor_pulse"), config.device);
  refuse_shared_inputs(config, root);
  return config;
}

}  // namespace

std::vector<const AnalogInput*> analog_inputs(const Config& config) {
  std::vector<const AnalogInput*> inputs{&config.laser.input, &config.voltage.input, &config.current.input};
  if (config.second_laser) inputs.push_back(&config.second_laser->input);
  if (config.relay_contact) inputs.push_back(&config.relay_contact->input);
  return inputs;
}

Config parse_config(const std::string& text, const std::string& name) {
  return parse_toml(text, name, read);
}

Config read_config(const std::filesystem::path& file) {
  return parse_config(
      read_file(file, "give the stage's configuration; a sample is drivers/nidaqmx/usb6211.toml"),
      file.string());
}

}  // namespace biopsy::nidaqmx
