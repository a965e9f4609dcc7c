#include "planner/imaging/io/dicom/jpeg2000.hpp"

#include <fmt/format.h>
#include <openjpeg.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

struct Memory {
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;
};

constexpr OPJ_SIZE_T kNoMore = static_cast<OPJ_SIZE_T>(-1);

OPJ_SIZE_T read_bytes(void* to, OPJ_SIZE_T count, void* user) {
  Memory& memory = *static_cast<Memory*>(user);
  const std::size_t got = std::min<std::size_t>(count, memory.bytes.size() - memory.at);
  if (got == 0) return kNoMore;
  std::memcpy(to, memory.bytes.data() + memory.at, got);
  memory.at += got;
  return got;
}

OPJ_OFF_T skip_bytes(OPJ_OFF_T count, void* user) {
  Memory& memory = *static_cast<Memory*>(user);
  const auto left = static_cast<OPJ_OFF_T>(memory.bytes.size() - memory.at);
  if (count < 0 || count > left) return -1;
  memory.at += static_cast<std::size_t>(count);
  return count;
}

OPJ_BOOL seek_bytes(OPJ_OFF_T to, void* user) {
  Memory& memory = *static_cast<Memory*>(user);
  if (to < 0 || to > static_cast<OPJ_OFF_T>(memory.bytes.size())) return OPJ_FALSE;
  memory.at = static_cast<std::size_t>(to);
  return OPJ_TRUE;
}

using Stream = std::unique_ptr<opj_stream_t, decltype(&opj_stream_destroy)>;
using Codec = std::unique_ptr<opj_codec_t, decltype(&opj_destroy_codec)>;
using Image = std::unique_ptr<opj_image_t, decltype(&opj_image_destroy)>;

Stream stream_of(Memory& memory) {
  Stream stream(opj_stream_create(1 << 16, OPJ_TRUE), &opj_stream_destroy);
  opj_stream_set_user_data(stream.get(), &memory, nullptr);
  opj_stream_set_user_data_length(stream.get(), memory.bytes.size());
  opj_stream_set_read_function(stream.get(), read_bytes);
  opj_stream_set_skip_function(stream.get(), skip_bytes);
  opj_stream_set_seek_function(stream.get(), seek_bytes);
  return stream;
}

bool is_jp2_file(std::span<const std::uint8_t> bytes) {
  constexpr std::uint8_t kBox[] = {0, 0, 0, 12, 'j', 'P', ' ', ' '};
  return bytes.size() > sizeof(kBox) && std::equal(std::begin(kBox), std::end(kBox), bytes.begin());
}

}  // namespace

std::vector<std::int32_t> decode_jpeg2000(std::span<const std::uint8_t> bytes, int columns, int rows,
                                          int bits, bool is_signed, const std::string& file) {
  const auto refuse = [&](const std::string& what) {
    throw ConfigError(what, file, "copy the file again, or export the series uncompressed");
  };
  const std::string damaged = "JPEG 2000 that cannot be decoded, truncated or damaged";
  Memory memory{bytes};
  const Stream stream = stream_of(memory);
  const Codec codec(opj_create_decompress(is_jp2_file(bytes) ? OPJ_CODEC_JP2 : OPJ_CODEC_J2K),
                    &opj_destroy_codec);
  opj_dparameters_t parameters;
  opj_set_default_decoder_parameters(&parameters);
  if (!codec || !opj_setup_decoder(codec.get(), &parameters)) refuse(damaged);
  opj_decoder_set_strict_mode(codec.get(), OPJ_TRUE);  // a truncated stream is none
  opj_image_t* raw = nullptr;
  const bool header = opj_read_header(stream.get(), codec.get(), &raw);
  const Image image(raw, &opj_image_destroy);
  if (!header || !image) refuse(damaged);
  if (image->numcomps != 1) refuse(fmt::format("a colour image ({} components)", image->numcomps));
  const opj_image_comp_t& component = image->comps[0];
  if (component.w != static_cast<OPJ_UINT32>(columns) || component.h != static_cast<OPJ_UINT32>(rows))
    refuse(fmt::format("{} x {} pixels are compressed, the header says {} x {}", component.w, component.h,
                       columns, rows));
  if (component.prec != static_cast<OPJ_UINT32>(bits) || (component.sgnd != 0) != is_signed)
    refuse(fmt::format("{} bits are compressed, {}, the header says {}, {}", component.prec,
                       component.sgnd ? "signed" : "unsigned", bits, is_signed ? "signed" : "unsigned"));
  if (!opj_decode(codec.get(), stream.get(), image.get()) || !image->comps[0].data) refuse(damaged);
  const std::size_t pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  return {image->comps[0].data, image->comps[0].data + pixels};
}

}  // namespace biopsy::imaging
