// Calibration of the tip offset of one needle in one sequence: measurements of a needle at known depth, and
// the signed file that holds them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot/msg/tip_offset.hpp"

namespace biopsy::robot {

inline constexpr double kOffsetMost_mm = 20.0;  // either way: no void ends farther from the tip

// One insertion: how far the void ended beyond the known depth of the tip.
struct TipMeasurement {
  double offset_mm = 0.0, sigma_mm = 0.0;
  std::string source;  // images and date, for readers
};

struct TipCalibration {
  TipOffset offset;
  std::vector<TipMeasurement> measurements;
};

// Weighted mean. The standard deviation is that of the next insertion: of the mean, and of the scatter
// between insertions, which one alone does not show: 0.3 mm is then assumed. At least one measurement.
TipOffset tip_offset_of(const std::string& needle, const std::string& sequence,
                        const std::vector<TipMeasurement>& measurements);

std::string tip_calibration_toml(const TipCalibration& calibration);

// Reads the file and its signature, NAME.sig beside NAME.toml, by `public_key` (empty: the key of this
// machine that signs commissioning records). Unsigned only for the sequence "simulated". Throws ConfigError
// naming file and line; for a signature that does not fit, too.
TipCalibration read_tip_calibration(const std::filesystem::path& file,
                                    const std::filesystem::path& public_key = {});

std::filesystem::path signature_of(const std::filesystem::path& file);

}  // namespace biopsy::robot
