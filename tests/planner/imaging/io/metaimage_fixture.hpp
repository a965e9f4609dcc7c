// MetaImage files for tests, written from the format's description.
#pragma once

#include <zlib.h>

#include <string>

namespace biopsy::imaging {

// 4 x 5 x 6 voxels of 16 bits, 1 x 2 x 3 mm; axes along P, I and L of LPS; the first voxel at LPS (10, 20,
// 30).
inline std::string metaimage_header(bool packed, const std::string& data = "LOCAL") {
  return std::string("ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n") +
         "CompressedData = " + (packed ? "True" : "False") +
         "\nTransformMatrix = 0 1 0 0 0 -1 1 0 0\nOffset = 10 20 30\nCenterOfRotation = 0 0 0\n"
         "AnatomicalOrientation = RAI\nElementSpacing = 1 2 3\nDimSize = 4 5 6\nElementType = MET_SHORT\n"
         "ElementDataFile = " +
         data + "\n";
}

// Voxel n holds n - 10.
inline std::string metaimage_voxels(bool packed) {
  std::string bytes;
  for (int n = 0; n < 120; ++n) {
    const auto value = static_cast<short>(n - 10);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  if (!packed) return bytes;
  std::string squeezed(compressBound(bytes.size()), '\0');
  uLongf size = squeezed.size();
  compress(reinterpret_cast<Bytef*>(squeezed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           bytes.size());
  squeezed.resize(size);
  return squeezed;
}

}  // namespace biopsy::imaging
