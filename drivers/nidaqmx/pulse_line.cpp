#include "drivers/nidaqmx/pulse_line.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"

namespace biopsy::nidaqmx {
namespace {

SupervisorPulse wired_in(const Config& config) {
  if (!config.supervisor_pulse)
    throw ConfigError("the supervisor has no line to its half of the interlock", "[supervisor_pulse]",
                      "wire one from a second board and name it; see docs/how-to/commission-a-stage.md");
  return *config.supervisor_pulse;
}

}  // namespace

PulseLine::PulseLine(const Config& config)
    : wired_(wired_in(config)),
      timeout_s_(config.timeout_s),
      daqmx_(load_daqmx(config.library)),
      name_(fmt::format("{}/port{}/line{}", wired_.device, wired_.port, wired_.line)),
      task_(daqmx_, "biopsy supervisor") {
  require_success(daqmx_, daqmx_.create_do_chan(task_.handle(), name_.c_str(), "", kChanForAllLines), name_);
  task_.start(name_);
  require_success(daqmx_, daqmx_.write_digital_scalar_u32(task_.handle(), 0, timeout_s_, 0, nullptr), name_);
}

PulseLine::~PulseLine() {
  daqmx_.write_digital_scalar_u32(task_.handle(), 0, timeout_s_, 0, nullptr);
}

void PulseLine::pulse() {
  if (failed_) return;
  high_ = !high_;
  const std::uint32_t lines = high_ ? 1U << wired_.line : 0U;
  failed_ = daqmx_.write_digital_scalar_u32(task_.handle(), 0, timeout_s_, lines, nullptr) < 0;
}

}  // namespace biopsy::nidaqmx
