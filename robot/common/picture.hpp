// A picture for people: 8-bit RGB, rows from the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace biopsy {

struct Picture {
  int width = 0, height = 0;
  double mm_per_pixel = 0.0;      // 0 where the picture has no scale
  std::vector<std::uint8_t> rgb;  // 3 * width * height

  static Picture blank(int width, int height, double mm_per_pixel) {
    return {
        width, height, mm_per_pixel,
        std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  }
};

}  // namespace biopsy
