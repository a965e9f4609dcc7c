#include "planner/imaging/io/volume_files.hpp"

#include <algorithm>

#include "planner/imaging/io/dicom/dicom_header.hpp"
#include "planner/imaging/io/metaimage/metaimage_reader.hpp"
#include "planner/imaging/io/nifti/nifti_reader.hpp"
#include "planner/imaging/io/nrrd/nrrd_reader.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace fs = std::filesystem;

namespace {

constexpr const char* kFormats =
    "give DICOM, NIfTI (.nii, .nii.gz), NRRD (.nrrd, .nrrd.gz, .nhdr) or MetaImage (.mha, .mhd)";

std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, error);
  for (; !error && at != fs::recursive_directory_iterator(); at.increment(error))
    if (at->is_regular_file(error)) files.push_back(at->path());
  // A folder that cannot be read may hold the missing half of a series.
  if (error)
    throw ConfigError("cannot be read: " + error.message(), folder.string(), "check the permissions");
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

void add_volume_file(const fs::path& file, VolumeFiles& files) {
  if (looks_like_nifti(file))
    files.nifti.push_back(file);
  else if (looks_like_nrrd(file))
    files.nrrd.push_back(file);
  else if (looks_like_metaimage(file))
    files.metaimage.push_back(file);
  else if (looks_like_dicom(file))
    files.dicom.push_back(file);
}

VolumeFiles find_volume_files(const fs::path& path) {
  VolumeFiles files;
  std::error_code error;
  if (!fs::exists(path, error))
    throw ConfigError("there is no such file or folder", path.string(), "check the name");
  if (fs::is_directory(path, error)) {
    for (const fs::path& file : files_below(path)) add_volume_file(file, files);
    if (files.empty()) throw ConfigError("no image in this folder", path.string(), kFormats);
    return files;
  }
  if (fs::is_regular_file(path, error)) add_volume_file(path, files);
  if (files.empty()) throw ConfigError("not an image of a known format", path.string(), kFormats);
  return files;
}

}  // namespace biopsy::imaging
