#include "robot/report/plot/png.hpp"

#include <png.h>

#include <cassert>
#include <stdexcept>
#include <vector>

#include "robot/common/files/file.hpp"
#include "robot/common/text/encoding.hpp"

namespace biopsy::report {
namespace {

bool is_grey(const Picture& picture) {
  for (std::size_t at = 0; at + 2 < picture.rgb.size(); at += 3)
    if (picture.rgb[at] != picture.rgb[at + 1] || picture.rgb[at] != picture.rgb[at + 2]) return false;
  return true;
}

std::vector<png_byte> first_channel(const Picture& picture) {
  std::vector<png_byte> grey;
  grey.reserve(picture.rgb.size() / 3);
  for (std::size_t at = 0; at < picture.rgb.size(); at += 3) grey.push_back(picture.rgb[at]);
  return grey;
}

}  // namespace

std::string png_bytes(const Picture& picture) {
  if (picture.width <= 0 || picture.height <= 0) return {};
  assert(picture.rgb.size() ==
         3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
  const bool grey = is_grey(picture);
  const std::vector<png_byte> pixels = grey ? first_channel(picture) : picture.rgb;

  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width);
  image.height = static_cast<png_uint_32>(picture.height);
  image.format = grey ? PNG_FORMAT_GRAY : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr))
    throw std::runtime_error(std::string("libpng: ") + image.message);
  bytes.resize(size);
  return bytes;
}

void save_png(const Picture& picture, const std::filesystem::path& path) {
  atomic_write(path, png_bytes(picture));
}

std::string png_data_uri(const Picture& picture) {
  return "data:image/png;base64," + base64(png_bytes(picture));
}

}  // namespace biopsy::report
