// What of a pulse sequence shapes the picture of a needle.
#pragma once

#include <cstdint>
#include <string>

#include "robot/common/frames.hpp"
#include "robot/common/units.hpp"

namespace biopsy::sim {

inline constexpr double kProton_Hz_per_T = 42.577478e6;  // gamma / 2 pi

struct Sequence {
  enum class Echo : std::uint8_t { Gradient, Spin };
  enum class Profile : std::uint8_t {
    Box,
    Gaussian
  };  // of the slice; a Gaussian's thickness is its width at half height

  Echo echo = Echo::Gradient;
  double b0_T = 1.5;
  Direction b0_S = Direction::UnitZ();  // of the static field: head to feet in a closed bore, sign immaterial
  double echo_time_ms = 5.0;            // of no consequence for a spin echo
  double bandwidth_Hz_per_pixel = 260.0;
  int read_axis = 0;           // of the image: 0 along rows (i), 1 along columns (j)
  bool read_reversed = false;  // a higher frequency is then seen at a lower index
  double slice_bandwidth_Hz =
      1500.0;                       // of the excitation, over one slice thickness; 0: 3-D encoding, no shift
  double slice_thickness_mm = 0.0;  // 0: the spacing of the image's slices
  Profile profile = Profile::Box;

  double larmor_Hz() const { return kProton_Hz_per_T * b0_T; }
};

// Throws ConfigError: a number outside [0.05, 15] T, [0, 200] ms, [10, 10^5] Hz a pixel, [0, 10^5] Hz,
// [0, 50] mm, a read axis other than 0 and 1, no direction of the field.
void refuse_bad_sequence(const Sequence& sequence, const std::string& where);

}  // namespace biopsy::sim
