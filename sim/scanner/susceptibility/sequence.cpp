#include "sim/scanner/susceptibility/sequence.hpp"

#include <fmt/format.h>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {

void refuse_bad_sequence(const Sequence& sequence, const std::string& where) {
  const auto within = [&](double value, double low, double high, const char* name, const char* unit) {
    if (!(value >= low && value <= high))
      throw ConfigError(fmt::format("{} {:g} {} is outside [{:g}, {:g}]", name, value, unit, low, high),
                        where, "give the value of the scanner's protocol");
  };
  within(sequence.b0_T, 0.05, 15.0, "static field", "T");
  within(sequence.echo_time_ms, 0.0, 200.0, "echo time", "ms");
  within(sequence.bandwidth_Hz_per_pixel, 10.0, 1e5, "bandwidth", "Hz per pixel");
  within(sequence.slice_bandwidth_Hz, 0.0, 1e5, "bandwidth of the excitation", "Hz");
  within(sequence.slice_thickness_mm, 0.0, 50.0, "slice thickness", "mm");
  within(sequence.read_axis, 0, 1, "read axis", "");
  if (!sequence.b0_S.allFinite() || sequence.b0_S.norm() < 1e-6)
    throw ConfigError("the direction of the static field is no direction", where,
                      "give a vector of the scanner frame; 0, 0, 1 in a closed bore");
}

}  // namespace biopsy::sim
