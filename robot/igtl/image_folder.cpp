#include "robot/igtl/image_folder.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <exception>

#include "planner/imaging/io/grid_rules.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::igtl {
namespace {

constexpr int kImagesMax = 200;  // of one start of the program: nobody fills the disk from the network

const char* nrrd_type(Image::Scalar scalar) {
  switch (scalar) {
    case Image::Scalar::Int8:
      return "int8";
    case Image::Scalar::UInt8:
      return "uint8";
    case Image::Scalar::Int16:
      return "int16";
    case Image::Scalar::UInt16:
      return "uint16";
    case Image::Scalar::Int32:
      return "int32";
    case Image::Scalar::UInt32:
      return "uint32";
    case Image::Scalar::Float32:
      return "float";
    case Image::Scalar::Float64:
      return "double";
  }
  return "";
}

constexpr std::string_view kPrefix = "igtl-";

// Of "igtl-012-scan.nrrd" 12; of other files 0.
int number_in(const std::string& name) {
  int number = 0;
  if (name.starts_with(kPrefix))
    std::from_chars(name.data() + kPrefix.size(), name.data() + name.size(), number);
  return number;
}

Grid grid_of(const Image& image) {
  const double sign = image.ras ? -1.0 : 1.0;
  const Eigen::Vector3d to_lps(sign, sign, 1.0);
  Grid grid;
  Point first(image.centre[0], image.centre[1], image.centre[2]);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d step(image.axes[3 * axis], image.axes[3 * axis + 1], image.axes[3 * axis + 2]);
    grid.size[static_cast<Eigen::Index>(axis)] = image.size[axis];
    grid.X_SI.linear().col(static_cast<Eigen::Index>(axis)) = to_lps.cwiseProduct(step);
    first -= 0.5 * (image.size[axis] - 1) * step;
  }
  grid.X_SI.translation() = to_lps.cwiseProduct(first);
  return grid;
}

// What nobody could plan on or confirm with is refused while its sender still listens.
void refuse_unusable(const Image& image, const std::string& device) {
  imaging::refuse_bad_grid(grid_of(image), device);
  const auto all_finite = [&]<class Real>(Real) {
    for (std::size_t at = 0; at + sizeof(Real) <= image.voxels.size(); at += sizeof(Real)) {
      Real voxel = 0;
      std::memcpy(&voxel, image.voxels.data() + at, sizeof voxel);
      if (!std::isfinite(static_cast<float>(voxel))) return false;
    }
    return true;
  };
  const bool finite = image.scalar == Image::Scalar::Float32   ? all_finite(0.0F)
                      : image.scalar == Image::Scalar::Float64 ? all_finite(0.0)
                                                               : true;
  if (!finite) throw ConfigError("a voxel is not a finite number", device, "say what these voxels are");
}

}  // namespace

std::string nrrd_of(const Image& image) {
  const Grid grid = grid_of(image);
  const auto vector = [](const Eigen::Vector3d& of) {
    return fmt::format("({:.9g},{:.9g},{:.9g})", of.x(), of.y(), of.z());
  };
  std::string text = fmt::format(
      "NRRD0004\ntype: {}\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
      "space directions: {} {} {}\nkinds: domain domain domain\nendian: little\nencoding: raw\n"
      "space origin: {}\n\n",
      nrrd_type(image.scalar), image.size[0], image.size[1], image.size[2], vector(grid.X_SI.linear().col(0)),
      vector(grid.X_SI.linear().col(1)), vector(grid.X_SI.linear().col(2)), vector(grid.X_SI.translation()));
  text.append(image.voxels.begin(), image.voxels.end());
  return text;
}

ImageFolder::ImageFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (!folder_.empty() && !std::filesystem::is_directory(folder_))
    throw ConfigError("the folder for images does not exist", folder_.string(),
                      "make it, or leave --images-to away");
  if (folder_.empty()) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    last_ = std::max(last_, number_in(entry.path().filename().string()));
}

std::variant<std::string, Refused> ImageFolder::store(const std::string& device, const Image& image) {
  if (folder_.empty()) return Refused{"images are not taken: start with --images-to FOLDER"};
  if (stored_ >= kImagesMax)
    return Refused{fmt::format("{} images were taken; start the program again", stored_)};
  std::string letters;
  for (const char letter : device)
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0) letters += letter;
  const std::string name =
      fmt::format("{}{:03}{}{}.nrrd", kPrefix, last_ + 1, letters.empty() ? "" : "-", letters);
  try {
    refuse_unusable(image, device);
    atomic_write(folder_ / name, nrrd_of(image));
  } catch (const ConfigError& error) {
    return Refused{error.what_is_wrong};
  } catch (const std::exception& error) {
    return Refused{error.what()};
  }
  ++stored_, ++last_;
  return name;
}

}  // namespace biopsy::igtl
