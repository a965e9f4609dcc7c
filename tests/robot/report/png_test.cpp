#include "robot/report/plot/png.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include "robot/report/plot/needle_overlay.hpp"
#include "tests/robot/report/example_run.hpp"

namespace biopsy::report {
namespace {

Picture decoded(const std::string& bytes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) return {};
  image.format = PNG_FORMAT_RGB;
  Picture picture = Picture::blank(static_cast<int>(image.width), static_cast<int>(image.height), 0.0);
  if (!png_image_finish_read(&image, nullptr, picture.rgb.data(), 0, nullptr)) return {};
  return picture;
}

Picture colourful(int width, int height) {
  Picture picture = Picture::blank(width, height, 1.0);
  for (std::size_t i = 0; i < picture.rgb.size(); ++i)
    picture.rgb[i] = static_cast<std::uint8_t>(i * 7919 >> 3);
  return picture;
}

TEST(Png, DecodesToTheSamePixelsInGreyAndInColour) {
  Picture bluish = example_run().planning_slice;  // grey but for the blue of one pixel
  bluish.rgb[3 * 1234 + 2] ^= 0x40;
  for (const Picture& picture : {example_run().planning_slice, bluish, colourful(37, 23), colourful(1, 1)}) {
    const Picture back = decoded(png_bytes(picture));
    EXPECT_EQ(back.width, picture.width);
    EXPECT_EQ(back.height, picture.height);
    EXPECT_EQ(back.rgb, picture.rgb);
  }
}

TEST(Png, GivesTheSameBytesEveryTimeAndNoneForAnEmptyPicture) {
  EXPECT_EQ(png_bytes(colourful(64, 64)), png_bytes(colourful(64, 64)));
  EXPECT_EQ(png_bytes(Picture{}), "");
}

TEST(Crop, CopiesPixelsAndIsBlackBeyondTheEdges) {
  const Picture whole = colourful(10, 8);
  for (const auto& [x, y] : {std::pair{-3, -2}, {4, 5}, {0, 0}, {20, 20}, {-30, 1}}) {
    const Picture part = cropped(whole, x, y, 9, 7);
    for (int row = 0; row < 7; ++row)
      for (int column = 0; column < 9; ++column) {
        const int from_x = column + x, from_y = row + y;
        const bool inside = from_x >= 0 && from_y >= 0 && from_x < 10 && from_y < 8;
        const auto at = [](int line, int place, int wide) {
          return 3 * static_cast<std::size_t>(line * wide + place);
        };
        ASSERT_EQ(part.rgb[at(row, column, 9)], inside ? whole.rgb[at(from_y, from_x, 10)] : 0);
      }
  }
}

}  // namespace
}  // namespace biopsy::report
