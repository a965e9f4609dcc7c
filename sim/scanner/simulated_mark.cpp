#include "sim/scanner/simulated_mark.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "sim/scanner/content_uid.hpp"

namespace biopsy::sim {
namespace {

constexpr std::array<std::string_view, 5> kLetters{"### ### # #", "#    #  ###", "###  #  ###", "  #  #  # #",
                                                   "### ### # #"};

std::string simulated_uid(const SeriesIdentity& original, const char* role) {
  return ContentUid()
      .add(original.study_uid)
      .add(original.frame_of_reference_uid)
      .add(std::string(role))
      .uid();
}

}  // namespace

void mark_simulated(Volume& image) {
  SeriesIdentity& identity = image.identity;
  const SeriesIdentity original = identity;
  identity.study_uid = simulated_uid(original, "simulated study");
  identity.frame_of_reference_uid = simulated_uid(original, "simulated frame of reference");
  identity.series_uid.clear();  // the writer names it by its content
  if (!original.patient_name.starts_with("SIMULATED^"))
    identity.patient_name = "SIMULATED^" + original.patient_name;
  if (!original.patient_id.starts_with("SIMULATED-"))
    identity.patient_id = "SIMULATED-" + original.patient_id;
  const int width = static_cast<int>(kLetters.front().size()), height = static_cast<int>(kLetters.size());
  if (image.voxels.empty() || image.grid.size.x() < 2 * width || image.grid.size.y() < 2 * height) return;
  const float bright = *std::max_element(image.voxels.begin(), image.voxels.end());
  for (int k = 0; k < image.grid.size.z(); ++k)
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i)
        if (kLetters[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] == '#')
          image.voxels[image.grid.index(i, j, k)] = bright;
}

}  // namespace biopsy::sim
