#include "planner/imaging/io/metaimage/metaimage_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <map>
#include <utility>

#include "planner/imaging/io/byte_source.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMetaHeaderMax = 1 << 16;

[[noreturn]] void refuse_metaimage(const std::string& what, const std::string& file) {
  throw ConfigError(what, file, "save the volume again as MetaImage, or give the DICOM series");
}

// "Key = Value" lines up to and with ElementDataFile, behind which the data may begin.
struct MetaHeader {
  std::map<std::string, std::string> fields;
  std::uint64_t length = 0;  // bytes
  std::string file;

  bool has(const std::string& name) const { return fields.contains(name); }
  const std::string& text(const std::string& name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) refuse_metaimage(fmt::format("field {} is missing", name), file);
    return found->second;
  }
  std::vector<double> numbers(const std::string& name, std::size_t count) const {
    const auto values = strict_numbers(text(name), ' ');
    if (!values || values->size() != count)
      refuse_metaimage(fmt::format("field {} does not hold {} numbers", name, count), file);
    return *values;
  }
  bool flag(const std::string& name) const {
    if (!has(name)) return false;
    const std::string& value = text(name);
    if (value != "True" && value != "False" && value != "true" && value != "false")
      refuse_metaimage(fmt::format("field {} is neither True nor False", name), file);
    return value == "True" || value == "true";
  }
  // The first of several names for one thing.
  std::string name_of(std::initializer_list<const char*> names) const {
    for (const char* name : names)
      if (has(name)) return name;
    return *names.begin();
  }
};

MetaHeader read_meta_header(const fs::path& path) {
  MetaHeader header;
  header.file = path.string();
  std::ifstream in(path, std::ios::binary);
  std::string head(kMetaHeaderMax, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  while (!header.has("ElementDataFile")) {
    const std::size_t end = head.find('\n', header.length);
    if (end == std::string::npos)
      refuse_metaimage("the header does not end with ElementDataFile", header.file);
    const std::string line = head.substr(header.length, end - header.length);
    header.length = end + 1;
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos)
      refuse_metaimage(fmt::format("header line without \"=\": \"{:.40}\"", line), header.file);
    const std::string name(trimmed(line.substr(0, equals))), value(trimmed(line.substr(equals + 1)));
    if (!header.fields.emplace(name, value).second)
      refuse_metaimage(fmt::format("field {:.40} is given twice", name), header.file);
  }
  return header;
}

VoxelType type_of(const MetaHeader& header) {
  using enum VoxelType;
  static constexpr std::pair<std::string_view, VoxelType> kTypes[] = {
      {"MET_CHAR", Int8},     {"MET_UCHAR", UInt8},   {"MET_SHORT", Int16},     {"MET_USHORT", UInt16},
      {"MET_INT", Int32},     {"MET_UINT", UInt32},   {"MET_LONG_LONG", Int64}, {"MET_ULONG_LONG", UInt64},
      {"MET_FLOAT", Float32}, {"MET_DOUBLE", Float64}};
  const std::string& name = header.text("ElementType");
  for (const auto& [known, type] : kTypes)
    if (known == name) return type;
  refuse_metaimage(fmt::format("voxel type {:.40} is not read", name), header.file);
}

void refuse_other_images(const MetaHeader& header) {
  if (header.has("ObjectType") && header.text("ObjectType") != "Image")
    refuse_metaimage(fmt::format("an object of type {:.40}, not an image", header.text("ObjectType")),
                     header.file);
  if (header.numbers("NDims", 1).front() != 3.0)
    refuse_metaimage(fmt::format("{:.10}-D: only three-dimensional images are read", header.text("NDims")),
                     header.file);
  if (header.has("ElementNumberOfChannels") && header.numbers("ElementNumberOfChannels", 1).front() != 1.0)
    refuse_metaimage("several channels a voxel (colour, vectors)", header.file);
  if (header.has("BinaryData") && !header.flag("BinaryData"))
    refuse_metaimage("the voxels are written as text", header.file);
  if (header.has("HeaderSize") && header.numbers("HeaderSize", 1).front() != 0.0)
    refuse_metaimage("a header within the data file is not skipped", header.file);
}

Grid grid_of(const MetaHeader& header, int slices_min) {
  Grid grid;
  const std::vector<double> size = header.numbers("DimSize", 3);
  const std::vector<double> spacing = header.numbers(header.name_of({"ElementSpacing"}), 3);
  const std::vector<double> offset = header.numbers(header.name_of({"Offset", "Position", "Origin"}), 3);
  const std::vector<double> axes =
      header.numbers(header.name_of({"TransformMatrix", "Rotation", "Orientation"}), 9);
  for (int a = 0; a < 3; ++a) {
    const auto at = static_cast<std::size_t>(a);
    if (!(size[at] >= 0.0 && size[at] <= 1e6) || size[at] != std::floor(size[at]))
      refuse_metaimage("field DimSize holds an impossible number", header.file);
    if (!(spacing[at] > 0.0))
      refuse_metaimage("field ElementSpacing holds a number that is not positive", header.file);
    const Eigen::Vector3d axis(axes[3 * at], axes[3 * at + 1], axes[3 * at + 2]);
    if (std::abs(axis.norm() - 1.0) > 1e-3)
      refuse_metaimage("a direction of TransformMatrix has not unit length", header.file);
    grid.size[a] = static_cast<int>(size[at]);
    grid.X_SI.linear().col(a) = spacing[at] * axis;
    grid.X_SI.translation()[a] = offset[at];
  }
  refuse_bad_grid(grid, header.file, slices_min);
  return grid;
}

struct OpenMetaImage {
  Volume volume;
  VoxelCoding coding;
  ByteSource source;
};

OpenMetaImage open_metaimage(const fs::path& path, int slices_min) {
  const MetaHeader header = read_meta_header(path);
  refuse_other_images(header);
  Volume volume;
  volume.grid = grid_of(header, slices_min);
  volume.format = "MetaImage";
  volume.files = {path.string()};
  VoxelCoding coding;
  coding.type = type_of(header);
  const bool big = header.flag(header.name_of({"BinaryDataByteOrderMSB", "ElementByteOrderMSB"}));
  coding.swapped = bytes_of(coding.type) > 1 && big != (std::endian::native == std::endian::big);
  const auto packing = header.flag("CompressedData") ? ByteSource::Packing::Zlib : ByteSource::Packing::Plain;
  const std::string& data = header.text("ElementDataFile");
  fs::path data_file = path;
  if (data != "LOCAL") {
    const fs::path name = data;
    const bool inside = !name.empty() && name.is_relative() &&
                        std::none_of(name.begin(), name.end(), [](const auto& part) { return part == ".."; });
    data_file = path.parent_path() / name;
    if (!inside || !fs::is_regular_file(data_file))
      refuse_metaimage(fmt::format("the data file \"{:.80}\" is not one file beside the header", data),
                       header.file);
    volume.files.push_back(data_file.string());
  }
  ByteSource source(data_file, packing, data == "LOCAL" ? header.length : 0);
  source.refuse_if_shorter_than(volume.grid.voxel_count() * bytes_of(coding.type));
  return {std::move(volume), coding, std::move(source)};
}

}  // namespace

bool looks_like_metaimage(const fs::path& file) {
  return file.extension() == ".mha" || file.extension() == ".mhd";
}

Volume read_metaimage_header(const fs::path& file) {
  return open_metaimage(file, kSizeMin).volume;
}

Volume read_metaimage(const fs::path& file, int slices_min) {
  OpenMetaImage open = open_metaimage(file, slices_min);
  read_voxels(open.source, open.coding, open.volume.files.back(), open.volume);
  if (open.source.rest() > 0)
    open.volume.warnings.push_back("the file holds more bytes than its header accounts for");
  return std::move(open.volume);
}

}  // namespace biopsy::imaging
