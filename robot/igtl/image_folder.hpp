// IMAGE messages as files, for the console's folder of images: NRRD, in LPS, each complete when it appears.
#pragma once

#include <filesystem>
#include <string>
#include <variant>

#include "robot/igtl/message.hpp"
#include "robot/igtl/reach.hpp"

namespace biopsy::igtl {

// An image as a NRRD file; the message's centre of the volume becomes the centre of the first voxel.
std::string nrrd_of(const Image& image);

class ImageFolder {
 public:
  // Empty: images are refused. Throws ConfigError where the folder does not exist.
  explicit ImageFolder(std::filesystem::path folder);

  // Name of the file, or why there is none. Of the device's name letters and digits are kept.
  std::variant<std::string, Refused> store(const std::string& device, const Image& image);

 private:
  std::filesystem::path folder_;
  int stored_ = 0;
  int last_ = 0;  // number in a name, of earlier starts too: their images stay
};

}  // namespace biopsy::igtl
