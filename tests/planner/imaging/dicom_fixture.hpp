// Small DICOM files for tests, made with DCMTK.
#pragma once

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmdata/dctk.h>

#include <array>
#include <filesystem>
#include <functional>
#include <string>

namespace biopsy::imaging {

struct SliceRecipe {
  int columns = 8, rows = 6;
  std::array<double, 3> position = {0, 0, 0};
  std::string orientation = "1\\0\\0\\0\\1\\0";
  std::string pixel_spacing = "2\\0.5";  // between rows, between columns
  std::string series_uid = "1.2.3.4";
  int bits_allocated = 16, bits_stored = 16;
  bool is_signed = true;
  E_TransferSyntax syntax = EXS_LittleEndianExplicit;
  std::function<int(int i, int j)> pixel = [](int i, int j) { return 10 * j + i; };
  std::function<void(DcmDataset&)> change = [](DcmDataset&) {};  // last word, before pixels are compressed
};

void write_slice(const std::filesystem::path& file, const SliceRecipe& recipe);

// Slices of the recipe at z = 0, step, 2 step ..., named a.dcm, b.dcm ..., with 100 k added to the pixels.
void write_stack(const std::filesystem::path& folder, SliceRecipe recipe, int slices, double step = 3.0);

// An enhanced multi-frame MR image: frames at z = 0, 3, 6 ... with 100 k added to the pixels; orientation and
// spacing in the shared groups, position and (slope 2, intercept k) in each frame's own.
void write_enhanced(const std::filesystem::path& file, SliceRecipe recipe, int frames);

}  // namespace biopsy::imaging
