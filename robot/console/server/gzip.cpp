#include "robot/console/server/gzip.hpp"

#include <zlib.h>

#include "robot/common/config_error.hpp"

namespace biopsy::console {

std::string gzip(std::string_view bytes) {
  constexpr int kGzip = 16, kWindow_bits = 15, kMemory = 9;
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kWindow_bits + kGzip, kMemory,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw ConfigError("cannot compress", "zlib", "free memory");
  std::string compressed(deflateBound(&stream, bytes.size()), '\0');
  std::string input(bytes);
  stream.next_in = reinterpret_cast<Bytef*>(input.data());
  stream.avail_in = static_cast<uInt>(input.size());
  stream.next_out = reinterpret_cast<Bytef*>(compressed.data());
  stream.avail_out = static_cast<uInt>(compressed.size());
  const int result = deflate(&stream, Z_FINISH);
  compressed.resize(stream.total_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw ConfigError("cannot compress", "zlib", "free memory");
  return compressed;
}

}  // namespace biopsy::console
