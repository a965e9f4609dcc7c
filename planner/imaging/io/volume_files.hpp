// Which files under a path hold images.
#pragma once

#include <filesystem>
#include <vector>

namespace biopsy::imaging {

struct VolumeFiles {
  std::vector<std::filesystem::path> dicom, nifti, nrrd, metaimage;  // sorted by name

  bool empty() const { return dicom.empty() && nifti.empty() && nrrd.empty() && metaimage.empty(); }
};

// One file, or a folder with all below it (links to folders are not followed, other files are ignored).
// Throws ConfigError when the path does not exist, cannot be read, or is one file of an unknown format.
VolumeFiles find_volume_files(const std::filesystem::path& path);

// Adds a file to those of its format; a file of none is ignored.
void add_volume_file(const std::filesystem::path& file, VolumeFiles& files);

}  // namespace biopsy::imaging
