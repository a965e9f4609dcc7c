#include "planner/imaging/io/byte_source.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "robot/common/config_error.hpp"

namespace biopsy::imaging {
namespace {

constexpr std::uint64_t kBestDeflate = 1032;  // zlib's documentation: the limit of the format is 1032:1
constexpr const char* kRemedyForDamage = "copy the file again";

// zlib puts its own name for the open file, "<fd:3>", before what is wrong with it.
std::string_view without_name(std::string_view text) {
  const std::size_t colon = text.find(">: ");
  return colon == std::string_view::npos ? text : text.substr(colon + 3);
}

}  // namespace

void ByteSource::Closer::operator()(void* file) const {
  gzclose(static_cast<gzFile>(file));
}

struct ByteSource::Inflater {
  z_stream stream{};
  std::array<unsigned char, 1 << 16> input;
  bool ended = false;
};

void ByteSource::InflaterDeleter::operator()(Inflater* inflater) const {
  inflateEnd(&inflater->stream);
  delete inflater;
}

ByteSource::ByteSource(const std::filesystem::path& file, Packing packing, std::uint64_t offset)
    : path_(file), packing_(packing) {
  const ConfigError unreadable("cannot be opened", file.string(), "check the name and the permissions");
  std::error_code error;
  const std::uint64_t length = std::filesystem::file_size(file, error);
  if (error) throw unreadable;
  if (offset > length)
    throw ConfigError("truncated: the data should begin behind the end of the file", file.string(),
                      kRemedyForDamage);
  most_left_ = (length - offset) * (packing == Packing::Plain ? 1 : kBestDeflate);
  if (packing != Packing::Gzip) {
    plain_.open(file, std::ios::binary);
    if (!plain_.seekg(static_cast<std::streamoff>(offset))) throw unreadable;
    if (packing == Packing::Plain) return;
    zlib_.reset(new Inflater);
    if (inflateInit(&zlib_->stream) != Z_OK) throw unreadable;
    return;
  }
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw unreadable;
  if (lseek(descriptor, static_cast<off_t>(offset), SEEK_SET) >= 0) gzip_.reset(gzdopen(descriptor, "rb"));
  if (!gzip_) {
    close(descriptor);
    throw unreadable;
  }
  gzbuffer(static_cast<gzFile>(gzip_.get()), 1 << 17);
  if (gzdirect(static_cast<gzFile>(gzip_.get())) != 0)  // zlib would pass the bytes through unchanged
    throw ConfigError("the data are not gzip", file.string(), kRemedyForDamage);
}

std::size_t ByteSource::read_some(std::byte* bytes, std::size_t count) {
  if (packing_ == Packing::Plain) {
    plain_.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(count));
    return static_cast<std::size_t>(plain_.gcount());
  }
  if (packing_ == Packing::Zlib) return inflate_some(bytes, count);
  const gzFile file = static_cast<gzFile>(gzip_.get());
  const int got = gzread(file, bytes, static_cast<unsigned>(std::min<std::size_t>(count, 1U << 24)));
  int code = Z_OK;
  const char* text = gzerror(file, &code);
  if (got < 0 || (code != Z_OK && code != Z_STREAM_END))
    throw ConfigError(fmt::format("truncated or damaged ({})", without_name(text)), path_.string(),
                      kRemedyForDamage);
  return static_cast<std::size_t>(got);
}

std::size_t ByteSource::inflate_some(std::byte* bytes, std::size_t count) {
  z_stream& stream = zlib_->stream;
  const uInt wanted = static_cast<uInt>(std::min<std::size_t>(count, 1U << 24));
  stream.next_out = reinterpret_cast<Bytef*>(bytes);
  stream.avail_out = wanted;
  while (stream.avail_out > 0 && !zlib_->ended) {
    if (stream.avail_in == 0) {
      plain_.read(reinterpret_cast<char*>(zlib_->input.data()),
                  static_cast<std::streamsize>(zlib_->input.size()));
      stream.next_in = zlib_->input.data();
      stream.avail_in = static_cast<uInt>(plain_.gcount());
      if (stream.avail_in == 0) break;  // the file ends before the stream does
    }
    const int code = inflate(&stream, Z_NO_FLUSH);
    zlib_->ended = code == Z_STREAM_END;
    if (code != Z_OK && code != Z_STREAM_END)
      throw ConfigError(fmt::format("truncated or damaged ({})", stream.msg ? stream.msg : "zlib"),
                        path_.string(), kRemedyForDamage);
  }
  return wanted - stream.avail_out;
}

void ByteSource::read(std::span<std::byte> bytes) {
  const std::size_t got = read_at_most(bytes);
  if (got < bytes.size())
    throw ConfigError(fmt::format("truncated: {} bytes missing", bytes.size() - got), path_.string(),
                      kRemedyForDamage);
}

std::size_t ByteSource::read_at_most(std::span<std::byte> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const std::size_t got = read_some(bytes.data() + done, bytes.size() - done);
    if (got == 0) break;
    done += got;
  }
  most_left_ -= std::min<std::uint64_t>(most_left_, done);
  return done;
}

void ByteSource::skip(std::uint64_t count) {
  refuse_if_shorter_than(count);
  std::array<std::byte, 4096> nowhere;
  for (; count > 0; count -= std::min<std::uint64_t>(count, nowhere.size()))
    read(std::span(nowhere).first(static_cast<std::size_t>(std::min<std::uint64_t>(count, nowhere.size()))));
}

void ByteSource::refuse_if_shorter_than(std::uint64_t count) const {
  if (count > most_left_)
    throw ConfigError(
        fmt::format("truncated: the header promises {} bytes, the file has room for {}", count, most_left_),
        path_.string(), kRemedyForDamage);
}

std::uint64_t ByteSource::rest(std::uint64_t limit) {
  std::array<std::byte, 4096> nowhere;
  std::uint64_t total = 0;
  while (total < limit) {
    const std::size_t got = read_some(nowhere.data(), nowhere.size());
    if (got == 0) break;
    total += got;
  }
  return total;
}

bool begins_like_gzip(const std::filesystem::path& file) {
  std::array<char, 2> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  return begin[0] == '\x1f' && begin[1] == '\x8b';
}

}  // namespace biopsy::imaging
