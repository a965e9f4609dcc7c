#include "planner/imaging/io/nrrd/nrrd_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "planner/imaging/io/grid_rules.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

constexpr const char* kNrrdRemedy =
    "save the volume again as NRRD with raw or gzip encoding, or give the DICOM series";
constexpr int kLayersMax = 256;
constexpr std::size_t kHeaderMax = 1 << 20;  // key/value pairs of segmentations reach tens of kilobytes

// Say nothing about where a voxel is or what it holds. The measurement frame concerns vectors and tensors
// only; the centring too, since the space origin is the centre of the first sample in either. Spacings
// without directions are no geometry, and with directions they say nothing new.
const std::set<std::string> kNeedless = {
    "content",           "number",   "thicknesses", "labels",       "min",       "max",
    "old min",           "old max",  "block size",  "sample units", "centers",   "centerings",
    "measurement frame", "spacings", "units",       "axis mins",    "axis maxs", "space dimension"};
const std::set<std::string> kUsed = {"type",         "dimension",   "sizes",    "encoding",
                                     "endian",       "space",       "kinds",    "space directions",
                                     "space origin", "space units", "data file"};

using Fields = std::map<std::string, std::string>;

struct HeaderText {
  Fields fields, keys;
  std::uint64_t length = 0;  // bytes up to and with the empty line
  bool ended = false;        // by an empty line (attached data), or by the end of the file
};

[[noreturn]] void refuse(const std::string& what, const std::string& file) {
  throw ConfigError(what, file, kNrrdRemedy);
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c); });
  return result;
}

void take_line(const std::string& line, const std::string& file, HeaderText& text) {
  if (line.front() == '#') return;
  const std::size_t colon = line.find(':');
  if (colon == std::string::npos) refuse(fmt::format("header line without a colon: \"{:.60}\"", line), file);
  if (line.compare(colon, 2, ":=") == 0) {  // a key of the program that wrote it
    const std::string key = line.substr(0, colon);
    if (!text.keys.emplace(key, line.substr(colon + 2)).second && key.starts_with("Segment"))
      refuse(fmt::format("key \"{:.60}\" is given twice", key), file);
    return;
  }
  std::string name = lower(trimmed(line.substr(0, colon)));
  if (name == "datafile") name = "data file";
  if (kNeedless.contains(name)) return;
  if (!kUsed.contains(name)) refuse(fmt::format("field \"{:.40}\" is not read", name), file);
  if (!text.fields.emplace(name, trimmed(line.substr(colon + 1))).second)
    refuse(fmt::format("field \"{}\" is given twice", name), file);
}

bool packed_as_a_whole(const std::filesystem::path& path) {
  return path.extension() == ".gz";
}

HeaderText read_text(const std::filesystem::path& path) {
  const std::string file = path.string();
  ByteSource source(path, packed_as_a_whole(path) ? ByteSource::Packing::Gzip : ByteSource::Packing::Plain);
  std::string head(kHeaderMax, '\0');
  head.resize(source.read_at_most(std::as_writable_bytes(std::span(head))));
  if (head.size() < 9 || head.compare(0, 7, "NRRD000") != 0 || head[7] < '1' || head[7] > '5')
    refuse("not an NRRD file (NRRD0001 to NRRD0005)", file);

  HeaderText text;
  for (std::size_t at = 0, line_number = 0; at < head.size(); ++line_number) {
    const std::size_t end = head.find('\n', at);
    if (end == std::string::npos && head.size() == kHeaderMax) refuse("the header does not end", file);
    std::string line = head.substr(at, end == std::string::npos ? end : end - at);
    if (line.ends_with('\r')) line.pop_back();
    at = end == std::string::npos ? head.size() : end + 1;
    text.length = at;
    if (line.empty()) {
      text.ended = true;
      return text;
    }
    if (line_number > 0) take_line(line, file, text);
  }
  return text;
}

const std::string& field(const Fields& fields, const char* name, const std::string& file) {
  const auto found = fields.find(name);
  if (found == fields.end()) refuse(fmt::format("field \"{}\" is missing", name), file);
  return found->second;
}

VoxelType type_of(const Fields& fields, const std::string& file) {
  using enum VoxelType;
  static constexpr std::pair<VoxelType, std::string_view> kNames[] = {
      {Int8, "|signed char|int8|int8_t|"},
      {UInt8, "|uchar|unsigned char|uint8|uint8_t|"},
      {Int16, "|short|short int|signed short|signed short int|int16|int16_t|"},
      {UInt16, "|ushort|unsigned short|unsigned short int|uint16|uint16_t|"},
      {Int32, "|int|signed int|int32|int32_t|"},
      {UInt32, "|uint|unsigned int|uint32|uint32_t|"},
      {Int64, "|longlong|long long|int64|int64_t|"},
      {UInt64, "|ulonglong|unsigned long long|uint64|uint64_t|"},
      {Float32, "|float|"},
      {Float64, "|double|"}};
  const std::string& name = field(fields, "type", file);
  const std::string wanted = fmt::format("|{}|", lower(name));
  for (const auto& [type, names] : kNames)
    if (name.find('|') == std::string::npos && names.find(wanted) != std::string_view::npos) return type;
  refuse(fmt::format("voxel type \"{:.40}\" is not read", name), file);
}

bool swapped_bytes(const Fields& fields, VoxelType type, const std::string& file) {
  if (bytes_of(type) == 1) return false;
  const std::string endian = lower(field(fields, "endian", file));
  if (endian != "little" && endian != "big")
    refuse(fmt::format("endian \"{:.20}\" is neither little nor big", endian), file);
  return (endian == "big") != (std::endian::native == std::endian::big);
}

ByteSource::Packing packing_of(const Fields& fields, const std::string& file) {
  const std::string encoding = lower(field(fields, "encoding", file));
  if (encoding == "raw") return ByteSource::Packing::Plain;
  if (encoding == "gzip" || encoding == "gz") return ByteSource::Packing::Gzip;
  refuse(fmt::format("encoding \"{:.20}\" is not read", encoding), file);
}

// Numbers of voxels; before them, where there is a list, that of its layers.
void read_size(const Fields& fields, NrrdLayers layers, int slices_min, const std::string& file,
               NrrdHeader& header) {
  const auto dimension = strict_integer(field(fields, "dimension", file));
  if (!dimension || *dimension < 1 || *dimension > 16)
    refuse("field \"dimension\" is not a number from 1 to 16", file);
  const bool listed = *dimension == 4 && layers == NrrdLayers::Allowed && fields.contains("kinds") &&
                      lower(fields.at("kinds")).starts_with("list ");
  if (*dimension != 3 && !listed)
    refuse(fmt::format("{}-D: only three-dimensional images of one number a voxel are read (no time series, "
                       "colour, vectors)",
                       *dimension),
           file);
  auto sizes = strict_numbers(field(fields, "sizes", file), ' ');
  if (!sizes || sizes->size() != (listed ? 4U : 3U))
    refuse(fmt::format("field \"sizes\" does not hold {} numbers", listed ? "four" : "three"), file);
  for (double size : *sizes)
    if (size < 0 || size > 1e6 || size != std::floor(size))
      refuse("field \"sizes\" holds an impossible number", file);
  if (listed) {
    if (sizes->front() < 1 || sizes->front() > kLayersMax)
      refuse(fmt::format("{} layers: 1 to {} are read", sizes->front(), kLayersMax), file);
    header.layers = static_cast<int>(sizes->front());
    sizes->erase(sizes->begin());
  }
  header.grid.size = Eigen::Map<const Eigen::Vector3d>(sizes->data()).cast<int>();
  refuse_bad_size(header.grid.size, file, slices_min);
  if (header.layers * header.grid.size.cast<double>().prod() > kVoxelsMax)
    refuse(fmt::format("{} layers of that size are more than 2^31 voxels", header.layers), file);
}

// Signs that carry the named space to LPS.
Eigen::Vector3d signs_to_lps(const Fields& fields, const std::string& file) {
  if (!fields.contains("space")) refuse("no geometry: field \"space\" is missing", file);
  const std::string space = lower(fields.at("space"));
  if (space == "left-posterior-superior" || space == "lps") return {1, 1, 1};
  if (space == "right-anterior-superior" || space == "ras") return {-1, -1, 1};
  if (space == "left-anterior-superior" || space == "las") return {1, -1, 1};
  refuse(fmt::format("space \"{:.40}\" does not say where left, posterior and superior are", space), file);
}

// The vectors "(a,b,c) (d,e,f) ..." of a field, exactly `count` of them; behind "none" for a list.
std::vector<Eigen::Vector3d> vectors(const Fields& fields, const char* name, std::size_t count,
                                     const std::string& file, bool listed = false) {
  std::string_view rest = trimmed(field(fields, name, file));
  std::vector<Eigen::Vector3d> result;
  const auto bad = [&] {
    refuse(fmt::format("field \"{}\" does not hold {} vectors of three numbers", name, count), file);
  };
  if (listed) {
    if (!rest.starts_with("none ")) bad();
    rest = trimmed(rest.substr(5));
  }
  while (!rest.empty()) {
    const std::size_t close = rest.find(')');
    if (rest.front() != '(' || close == std::string_view::npos) bad();
    const auto numbers = strict_numbers(rest.substr(1, close - 1), ',');
    if (!numbers || numbers->size() != 3) bad();
    result.emplace_back((*numbers)[0], (*numbers)[1], (*numbers)[2]);
    rest = trimmed(rest.substr(close + 1));
  }
  if (result.size() != count) bad();
  return result;
}

void refuse_odd_units_and_kinds(const Fields& fields, bool listed, const std::string& file) {
  if (fields.contains("space units")) {
    std::string units = fields.at("space units");
    std::erase_if(units, [](char c) { return c == '"' || c == ' '; });
    if (units != "mmmmmm")
      refuse(fmt::format("space units {:.40} are not mm", fields.at("space units")), file);
  }
  if (!fields.contains("kinds")) return;
  const std::string kinds = lower(fields.at("kinds")).substr(listed ? 5 : 0) + ' ';
  for (std::size_t at = 0, end; (end = kinds.find(' ', at)) != std::string::npos; at = end + 1) {
    const std::string kind = kinds.substr(at, end - at);
    if (!kind.empty() && kind != "domain" && kind != "space" && kind != "???" && kind != "none")
      refuse(fmt::format("an axis of kind \"{:.30}\" (time, colour, vector or complex) is not read", kind),
             file);
  }
}

void find_data(const std::filesystem::path& path, const HeaderText& text, NrrdHeader& header) {
  const auto detached = text.fields.find("data file");
  if (detached == text.fields.end()) {
    if (!text.ended)
      refuse("truncated: the header ends without an empty line and without data", path.string());
    header.data_file = path;
    if (!packed_as_a_whole(path)) {
      header.data_offset = text.length;
      return;
    }
    if (header.packing == ByteSource::Packing::Gzip)
      refuse("packed twice, as a file and as data", path.string());
    header.packing = ByteSource::Packing::Gzip;
    header.data_skip = text.length;
    return;
  }
  const std::filesystem::path name = detached->second;
  // A list or a pattern of files is refused by this too: such names do not exist.
  const bool inside = !name.empty() && name.is_relative() &&
                      std::none_of(name.begin(), name.end(), [](const auto& part) { return part == ".."; });
  if (!inside || !std::filesystem::is_regular_file(path.parent_path() / name))
    refuse(fmt::format("the data file \"{:.80}\" is not one file beside the header", name.string()),
           path.string());
  header.data_file = path.parent_path() / name;
}

}  // namespace

NrrdHeader read_nrrd_header_fields(const std::filesystem::path& path, NrrdLayers layers, int slices_min) {
  const std::string file = path.string();
  const HeaderText text = read_text(path);
  NrrdHeader header;
  header.keys = text.keys;
  read_size(text.fields, layers, slices_min, file, header);
  const bool listed = strict_integer(text.fields.at("dimension")) == 4;
  header.coding.type = type_of(text.fields, file);
  header.packing = packing_of(text.fields, file);
  header.coding.swapped = swapped_bytes(text.fields, header.coding.type, file);
  refuse_odd_units_and_kinds(text.fields, listed, file);

  const Eigen::Vector3d signs = signs_to_lps(text.fields, file);
  const auto directions = vectors(text.fields, "space directions", 3, file, listed);
  for (int axis = 0; axis < 3; ++axis)
    header.grid.X_SI.linear().col(axis) = signs.cwiseProduct(directions[static_cast<std::size_t>(axis)]);
  header.grid.X_SI.translation() = signs.cwiseProduct(vectors(text.fields, "space origin", 1, file).front());
  refuse_bad_grid(header.grid, file, slices_min);
  find_data(path, text, header);
  return header;
}

}  // namespace biopsy::imaging
