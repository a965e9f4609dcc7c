#include "tests/planner/imaging/io/jpeg2000_fixture.hpp"

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <openjpeg.h>

#include <algorithm>

#include "tests/planner/imaging/dicom_fixture.hpp"

namespace biopsy::imaging {
namespace {

OPJ_SIZE_T append(void* from, OPJ_SIZE_T count, void* user) {
  auto& bytes = *static_cast<std::vector<std::uint8_t>*>(user);
  const auto* first = static_cast<const std::uint8_t*>(from);
  bytes.insert(bytes.end(), first, first + count);
  return count;
}

}  // namespace

std::vector<std::uint8_t> jpeg2000_of(const std::vector<std::int32_t>& pixels, int columns, int rows,
                                      int bits, bool is_signed) {
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = static_cast<OPJ_UINT32>(columns), component.h = static_cast<OPJ_UINT32>(rows);
  component.prec = static_cast<OPJ_UINT32>(bits), component.sgnd = is_signed;
  opj_image_t* image = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
  image->x1 = component.w, image->y1 = component.h;
  std::copy(pixels.begin(), pixels.end(), image->comps[0].data);
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.numresolution = 2, parameters.tcp_numlayers = 1, parameters.cp_disto_alloc = 1;
  opj_codec_t* codec = opj_create_compress(OPJ_CODEC_J2K);
  opj_setup_encoder(codec, &parameters, image);
  std::vector<std::uint8_t> bytes;
  opj_stream_t* stream = opj_stream_create(1 << 16, OPJ_FALSE);
  opj_stream_set_user_data(stream, &bytes, nullptr);
  opj_stream_set_write_function(stream, append);
  opj_start_compress(codec, image, stream);
  opj_encode(codec, stream);
  opj_end_compress(codec, stream);
  opj_stream_destroy(stream);
  opj_destroy_codec(codec);
  opj_image_destroy(image);
  return bytes;
}

void write_jpeg2000_stack(const std::filesystem::path& folder, int slices) {
  SliceRecipe recipe;
  recipe.columns = 16, recipe.rows = 12;
  write_stack(folder, recipe, slices);
  for (int k = 0; k < slices; ++k) {
    const std::filesystem::path file = folder / (std::string(1, static_cast<char>('a' + k)) + ".dcm");
    DcmFileFormat content;
    content.loadFile(file.c_str());
    DcmDataset& dataset = *content.getDataset();
    const Sint16* words = nullptr;
    const Uint16* raw = nullptr;
    unsigned long count = 0;
    dataset.findAndGetUint16Array(DCM_PixelData, raw, &count);
    words = reinterpret_cast<const Sint16*>(raw);
    auto bytes = jpeg2000_of({words, words + 16 * 12}, 16, 12, 16, true);
    if (bytes.size() % 2) bytes.push_back(0);
    auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
    sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
    auto* item = new DcmPixelItem(DCM_PixelItemTag);
    item->putUint8Array(bytes.data(), bytes.size());
    sequence->insert(item);
    auto* pixels = new DcmPixelData(DCM_PixelData);
    pixels->putOriginalRepresentation(EXS_JPEG2000LosslessOnly, nullptr, sequence);
    dataset.insert(pixels, OFTrue);
    content.saveFile(file.c_str(), EXS_JPEG2000LosslessOnly);
  }
}

}  // namespace biopsy::imaging
