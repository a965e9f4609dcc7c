#include "planner/imaging/io/nrrd/nrrd_reader.hpp"

#include "planner/imaging/io/voxel_type.hpp"

namespace biopsy::imaging {
namespace {

Volume volume_without_voxels(const std::filesystem::path& file, const NrrdHeader& header) {
  Volume volume;
  volume.grid = header.grid;
  volume.format = "NRRD";
  volume.files = {file.string()};
  if (header.data_file != file) volume.files.push_back(header.data_file.string());
  return volume;
}

ByteSource open_data(const NrrdHeader& header) {
  ByteSource source(header.data_file, header.packing, header.data_offset);
  source.skip(header.data_skip);
  source.refuse_if_shorter_than(header.grid.voxel_count() * bytes_of(header.coding.type));
  return source;
}

}  // namespace

bool looks_like_nrrd(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return name.ends_with(".nrrd") || name.ends_with(".nhdr") || name.ends_with(".nrrd.gz");
}

Volume read_nrrd_header(const std::filesystem::path& file) {
  const NrrdHeader header = read_nrrd_header_fields(file);
  open_data(header);
  return volume_without_voxels(file, header);
}

Volume read_nrrd(const std::filesystem::path& file, int slices_min) {
  return read_nrrd_layers(file, read_nrrd_header_fields(file, NrrdLayers::Refused, slices_min));
}

Volume read_nrrd_layers(const std::filesystem::path& file, const NrrdHeader& header) {
  Volume volume = volume_without_voxels(file, header);
  ByteSource source = open_data(header);
  volume.grid.size.x() *= header.layers;  // as they lie in the file
  read_voxels(source, header.coding, header.data_file.string(), volume);
  volume.grid.size.x() = header.grid.size.x();
  if (source.rest() > 0) volume.warnings.push_back("the file holds more bytes than its header accounts for");
  return volume;
}

}  // namespace biopsy::imaging
