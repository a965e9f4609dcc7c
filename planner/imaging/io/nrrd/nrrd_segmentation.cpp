#include "planner/imaging/io/nrrd/nrrd_segmentation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "planner/imaging/io/nrrd/nrrd_header.hpp"
#include "planner/imaging/io/nrrd/nrrd_reader.hpp"
#include "planner/imaging/io/segment_labels.hpp"
#include "planner/imaging/io/voxel_type.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

constexpr const char* kSegmentationRemedy = "save the segmentation again in 3D Slicer, as .seg.nrrd";
constexpr std::int64_t kNumberMax = 999'999;

// One segment by its keys.
struct Segment {
  std::string name, id;
  std::optional<int> value, layer;
};

int key_number(const std::string& text, std::int64_t least, const std::string& key, const std::string& file) {
  const auto number = strict_integer(text);
  if (!number || *number < least || *number > kNumberMax)
    throw ConfigError(fmt::format("key \"{}\" is \"{:.20}\", not a number from {}", key, plain(text), least),
                      file, kSegmentationRemedy);
  return static_cast<int>(*number);
}

// "Segment12_Name" is (12, "Name").
std::optional<std::pair<int, std::string>> segment_key(const std::string& key) {
  constexpr std::string_view kPrefix = "Segment";
  const std::size_t underscore = key.find('_');
  if (!key.starts_with(kPrefix) || underscore == std::string::npos) return std::nullopt;
  const std::string digits = key.substr(kPrefix.size(), underscore - kPrefix.size());
  if (digits.empty() || digits.size() > 4 ||
      !std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  return std::pair(std::stoi(digits), key.substr(underscore + 1));
}

std::map<int, Segment> segments_of(const NrrdHeader& header, const std::string& file) {
  std::map<int, Segment> segments;
  for (const auto& [key, text] : header.keys) {
    const auto what = segment_key(key);
    if (!what) continue;
    Segment& segment = segments[what->first];
    if (what->second == "Name") segment.name = plain(trimmed(text));
    if (what->second == "ID") segment.id = plain(trimmed(text));
    if (what->second == "LabelValue") segment.value = key_number(text, 1, key, file);
    if (what->second == "Layer") segment.layer = key_number(text, 0, key, file);
  }
  return segments;
}

void refuse_other_representations(const NrrdHeader& header, const std::string& file) {
  for (const char* key : {"Segmentation_MasterRepresentation", "Segmentation_SourceRepresentation"}) {
    const auto found = header.keys.find(key);
    if (found == header.keys.end() || trimmed(found->second) == "Binary labelmap") continue;
    throw ConfigError(fmt::format("the segmentation is a \"{:.40}\"", plain(found->second)), file,
                      "save it with its binary labelmap as the source representation");
  }
}

// (layer, number in it) of each segment. Slicer 4.10 and older wrote a layer for each, with the number 1.
std::map<std::pair<int, int>, int> places_of(const std::map<int, Segment>& segments, int layers,
                                             const std::string& file) {
  std::map<std::pair<int, int>, int> places;
  for (const auto& [number, segment] : segments) {
    const int layer = segment.layer.value_or(layers > 1 ? number : 0);
    if (layer >= layers)
      throw ConfigError(fmt::format("segment {} lies in layer {}, and there are {}", number, layer, layers),
                        file, kSegmentationRemedy);
    const auto [place, is_new] = places.emplace(std::pair(layer, segment.value.value_or(1)), number);
    if (!is_new)
      throw ConfigError(
          fmt::format("segments {} and {} have the same label value in one layer", place->second, number),
          file, kSegmentationRemedy);
  }
  return places;
}

std::string name_of(const Segment& segment, int number) {
  return !segment.name.empty() ? segment.name
         : !segment.id.empty() ? segment.id
                               : fmt::format("segment {}", number);
}

int number_in(float value, const std::string& file) {
  if (!(value >= 0.0F && value <= static_cast<float>(kNumberMax)) || value != std::round(value))
    throw ConfigError(fmt::format("a voxel has the value {}, and segments have whole numbers from 0", value),
                      file, kSegmentationRemedy);
  return static_cast<int>(value);
}

// One volume out of the layers, which lie together in each voxel.
void join_layers(const std::map<std::pair<int, int>, int>& places, int layers, const std::string& file,
                 SegmentLabels& labels, std::vector<float>& voxels) {
  const std::size_t count = voxels.size() / static_cast<std::size_t>(layers);
  for (std::size_t n = 0; n < count; ++n) {
    int label = 0;
    for (int layer = 0; layer < layers; ++layer) {
      const int number =
          number_in(voxels[n * static_cast<std::size_t>(layers) + static_cast<std::size_t>(layer)], file);
      if (number == 0) continue;
      const auto segment = places.find({layer, number});
      if (segment == places.end())
        throw ConfigError(
            fmt::format("a voxel of layer {} has the number {}, which is no segment's", layer, number), file,
            kSegmentationRemedy);
      label = labels.joined(label, segment->second + 1);
    }
    voxels[n] = static_cast<float>(label);
  }
  voxels.resize(count);
}

}  // namespace

bool is_nrrd_segmentation(const std::filesystem::path& file) {
  if (!looks_like_nrrd(file) || !std::filesystem::is_regular_file(file)) return false;
  return !segments_of(read_nrrd_header_fields(file, NrrdLayers::Allowed), file.string()).empty();
}

LabelMap read_nrrd_segmentation(const std::filesystem::path& path) {
  const std::string file = path.string();
  const NrrdHeader header = read_nrrd_header_fields(path, NrrdLayers::Allowed);
  refuse_other_representations(header, file);
  const std::map<int, Segment> segments = segments_of(header, file);
  const auto places = places_of(segments, header.layers, file);

  LabelMap map;
  map.ends_unlabelled = true;
  map.volume = read_nrrd_layers(path, header);
  if (header.layers == 1) {
    for (const float value : map.volume.voxels) number_in(value, file);
    for (const auto& [place, number] : places) map.names[place.second] = name_of(segments.at(number), number);
    return map;
  }
  std::map<int, std::string> names;
  for (const auto& [number, segment] : segments) names[number + 1] = name_of(segment, number);
  SegmentLabels labels(std::move(names), file);
  join_layers(places, header.layers, file, labels, map.volume.voxels);
  map.names = labels.names();
  return map;
}

}  // namespace biopsy::imaging
