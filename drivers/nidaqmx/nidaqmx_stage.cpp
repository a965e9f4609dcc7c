#include "drivers/nidaqmx/nidaqmx_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "robot/common/config_error.hpp"

namespace biopsy::nidaqmx {
namespace {

constexpr double kCodes = 65536.0;  // of the 16-bit converter, over its range

std::string channel(const Config& config, const char* kind, std::uint32_t number) {
  return fmt::format("{}/{}{}", config.device, kind, number);
}

std::string line(const Config& config, std::uint32_t port, std::uint32_t number) {
  return fmt::format("{}/port{}/line{}", config.device, port, number);
}

void add_input(const DaqmxFunctions& daqmx, Task& task, const Config& config, const AnalogInput& input) {
  const std::string name = channel(config, "ai", input.number);
  require_success(daqmx,
                  daqmx.create_ai_voltage_chan(task.handle(), name.c_str(), "", input.terminal, input.low_V,
                                               input.high_V, kVolts, nullptr),
                  name);
}

// To whole micrometres, millivolts or nanoamperes.
std::int32_t rounded(double value) {
  constexpr double kMost = 2e9;
  return static_cast<std::int32_t>(std::lround(std::clamp(value, -kMost, kMost)));
}

std::int32_t depth_um(const Laser& laser, double volts) {
  return rounded((volts - laser.zero_V) * laser.mm_per_V * 1e3);
}

bool is_valid(const Laser& laser, double volts) {
  return volts >= laser.valid_low_V && volts <= laser.valid_high_V;
}

}  // namespace

std::int64_t monotonic_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

NidaqmxStage::NidaqmxStage(Config config, Clock clock)
    : config_(std::move(config)), clock_(clock), daqmx_(load_daqmx(config_.library)) {
  find_board();
  connect();
}

NidaqmxStage::~NidaqmxStage() {
  daqmx_.write_analog_scalar_f64(output_->handle(), 0, config_.timeout_s, 0.0, nullptr);
  daqmx_.write_digital_scalar_u32(lines_task_->handle(), 0, config_.timeout_s, 0, nullptr);
}

void NidaqmxStage::find_board() {
  std::array<char, 4096> text{};
  const auto size = static_cast<std::uint32_t>(text.size()) - 1;
  require_success(daqmx_, daqmx_.get_sys_dev_names(text.data(), size), "list of boards");
  const std::string present = fmt::format(", {},", text.data());
  if (present.find(fmt::format(" {},", config_.device)) == std::string::npos)
    throw ConfigError(fmt::format("there is no board of this name; there are: {}", text.data()),
                      config_.device,
                      "plug it in and see `nilsdev`, or correct `device` in the configuration");
  require_success(daqmx_, daqmx_.get_dev_product_type(config_.device.c_str(), text.data(), size),
                  config_.device);
  product_ = text.data();
  require_success(daqmx_, daqmx_.get_dev_serial_num(config_.device.c_str(), &serial_), config_.device);
  if (config_.serial && *config_.serial != serial_)
    throw ConfigError(fmt::format("this board's serial number is {}, not {}", serial_, *config_.serial),
                      config_.device, "connect the right board, or correct `serial` and commission anew");
  require_success(daqmx_, daqmx_.reset_device(config_.device.c_str()), config_.device + ", reset");
  require_success(daqmx_, daqmx_.self_test_device(config_.device.c_str()), config_.device + ", self test");
}

void NidaqmxStage::connect() {
  inputs_.emplace(daqmx_, "biopsy inputs");
  for (const AnalogInput* input : analog_inputs(config_)) add_input(daqmx_, *inputs_, config_, *input);
  inputs_->start("analog inputs");

  output_.emplace(daqmx_, "biopsy command");
  const std::string command = channel(config_, "ao", config_.command.number);
  require_success(daqmx_,
                  daqmx_.create_ao_voltage_chan(output_->handle(), command.c_str(), "", -kBoard_V, kBoard_V,
                                                kVolts, nullptr),
                  command);
  output_->start(command);
  require_success(
      daqmx_, daqmx_.write_analog_scalar_f64(output_->handle(), 0, config_.timeout_s, 0.0, nullptr), command);

  const Interlock& interlock = config_.interlock;
  std::string lines = line(config_, interlock.port, interlock.pulse_line);
  for (const std::optional<std::uint32_t>& other : {interlock.enable_line, interlock.brake_line})
    if (other) lines += ", " + line(config_, interlock.port, *other);
  lines_task_.emplace(daqmx_, "biopsy interlock");
  require_success(daqmx_, daqmx_.create_do_chan(lines_task_->handle(), lines.c_str(), "", kChanForAllLines),
                  lines);
  lines_task_->start(lines);
  require_success(daqmx_,
                  daqmx_.write_digital_scalar_u32(lines_task_->handle(), 0, config_.timeout_s, 0, nullptr),
                  lines);

  if (!config_.panel) return;
  const PanelInputs& panel = *config_.panel;
  std::string contacts;
  for (const std::uint32_t contact :
       {panel.arm_line, panel.reset_line, panel.estop_a_line, panel.estop_b_line})
    contacts += (contacts.empty() ? "" : ", ") + line(config_, panel.port, contact);
  panel_task_.emplace(daqmx_, "biopsy panel");
  require_success(
      daqmx_, daqmx_.create_di_chan(panel_task_->handle(), contacts.c_str(), "", kChanForAllLines), contacts);
  panel_task_->start(contacts);
}

bool NidaqmxStage::is_good(Status status) {
  if (status >= 0) return true;
  daqmx_.get_extended_error_info(error_.text.data(), static_cast<std::uint32_t>(error_.text.size()) - 1);
  error_.status = status;
  ++error_.count;
  const ErrorKind kind = error_kind(status);
  if (kind != ErrorKind::Stale && kind != ErrorKind::Overrun) stop_for_good();
  return false;
}

bool NidaqmxStage::read_voltages() {
  std::int32_t read = 0;
  const auto size = static_cast<std::uint32_t>(volts_.size());
  const Status status = daqmx_.read_analog_f64(inputs_->handle(), 1, config_.timeout_s, kGroupByChannel,
                                               volts_.data(), size, &read, nullptr);
  const auto finite = [](double volts) { return std::isfinite(volts); };
  return is_good(status) && read == 1 && std::all_of(volts_.begin(), volts_.end(), finite);
}

// In integer format the bits of a port are its lines, whichever of them the channel holds.
bool NidaqmxStage::read_panel() {
  std::uint32_t lines = 0;
  if (!panel_task_) return true;
  if (!is_good(daqmx_.read_digital_scalar_u32(panel_task_->handle(), config_.timeout_s, &lines, nullptr)))
    return false;
  const auto is_high = [lines](std::uint32_t number) { return (lines >> number & 1U) != 0; };
  panel_.arm = is_high(config_.panel->arm_line);
  panel_.reset = is_high(config_.panel->reset_line);
  panel_.estop_a_closed = is_high(config_.panel->estop_a_line);
  panel_.estop_b_closed = is_high(config_.panel->estop_b_line);
  return true;
}

drivers::SensorReading NidaqmxStage::read() {
  fresh_ = panel_.read = false;
  reading_.laser_valid = reading_.laser_b_valid = false;
  if (stopped_) return reading_;
  const std::int64_t now_us = clock_();
  const bool complete = read_panel() && read_voltages();
  if (stopped_) panel_ = {};
  if (!stopped_) reading_.time_us = now_us;
  if (!complete) return reading_;
  if (config_.relay_contact)
    panel_.relay_closed = volts_[config_.second_laser ? 4 : 3] > config_.relay_contact->closed_V;
  panel_.read = panel_task_.has_value();
  const Laser& laser = config_.laser;
  const double step_V = (laser.input.high_V - laser.input.low_V) / kCodes;
  reading_.laser_code = rounded(volts_[0] / step_V);
  reading_.depth_um = depth_um(laser, volts_[0]);
  reading_.laser_valid = is_valid(laser, volts_[0]);
  if (config_.second_laser) {
    reading_.depth_b_um = depth_um(*config_.second_laser, volts_[3]);
    reading_.laser_b_valid = is_valid(*config_.second_laser, volts_[3]);
  }
  reading_.monitor_mV = rounded(volts_[1] * config_.voltage.per_V * 1e6);
  reading_.current_nA = rounded(volts_[2] * config_.current.per_V * 1e6);
  reading_.brake_fitted = config_.interlock.brake_line.has_value();
  fresh_ = true;
  return reading_;
}

std::int32_t NidaqmxStage::write(const safety::GatedVoltage& voltage) {
  const bool on = voltage.hv_enabled() && !stopped_;
  const double most_V = config_.command.highest_kV / config_.command.kV_per_V;
  const double wanted_V = voltage.mV() * 1e-6 / config_.command.kV_per_V;
  const double command_V = on ? std::clamp(wanted_V, -most_V, most_V) : 0.0;
  const Status status =
      daqmx_.write_analog_scalar_f64(output_->handle(), 0, config_.timeout_s, command_V, nullptr);
  // Unlike a missed reading, a missed voltage stays on the converter.
  if (!is_good(status)) stop_for_good();
  write_lines(on && !stopped_, fresh_ && feeding_ && !stopped_ && voltage.feeds_interlock(),
              voltage.brake_on());
  return is_good(status) ? rounded(command_V * config_.command.kV_per_V * 1e6) : 0;
}

void NidaqmxStage::write_lines(bool enabled, bool pulse, bool brake) {
  const auto bit = [](std::uint32_t number) { return 1U << number; };
  std::uint32_t lines = lines_ & bit(config_.interlock.pulse_line);
  if (pulse) lines ^= bit(config_.interlock.pulse_line);
  if (enabled && config_.interlock.enable_line) lines |= bit(*config_.interlock.enable_line);
  if (enabled && brake && config_.interlock.brake_line) lines |= bit(*config_.interlock.brake_line);
  if (lines == lines_) return;
  if (is_good(daqmx_.write_digital_scalar_u32(lines_task_->handle(), 0, config_.timeout_s, lines, nullptr)))
    lines_ = lines;
  else
    stop_for_good();
}

}  // namespace biopsy::nidaqmx
