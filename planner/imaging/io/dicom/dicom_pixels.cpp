#include "planner/imaging/io/dicom/dicom_pixels.hpp"

#include <dcmtk/dcmdata/dcfcache.h>
#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <dcmtk/dcmdata/dcrledrg.h>
#include <dcmtk/dcmjpeg/djdecode.h>
#include <dcmtk/dcmjpls/djdecode.h>
#include <dcmtk/oflog/oflog.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <mutex>

#include "planner/imaging/io/dicom/dicom_fields.hpp"
#include "planner/imaging/io/dicom/jpeg2000.hpp"
#include "planner/imaging/io/grid_rules.hpp"
#include "robot/common/config_error.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {
namespace {

constexpr const char* kCopyAgain = "copy the file again from the scanner or archive";
constexpr const char* kUncompressed = "export the series uncompressed (Explicit VR Little Endian)";

bool is_encapsulated(const DcmXfer& syntax) {
#if PACKAGE_VERSION_NUMBER >= 368  // there the old name is deprecated
  return syntax.usesEncapsulatedFormat() && syntax.isPixelDataCompressed();
#else
  return syntax.isEncapsulated();
#endif
}

bool is_jpeg2000(E_TransferSyntax syntax) {
  return syntax == EXS_JPEG2000LosslessOnly || syntax == EXS_JPEG2000;
}

bool is_decoded(E_TransferSyntax syntax) {
  if (is_jpeg2000(syntax)) return true;
  switch (syntax) {
    case EXS_RLELossless:
    case EXS_JPEGProcess1:
    case EXS_JPEGProcess2_4:
    case EXS_JPEGProcess14:
    case EXS_JPEGProcess14SV1:
    case EXS_JPEGLSLossless:
    case EXS_JPEGLSLossy:
      return true;
    default:
      return !is_encapsulated(DcmXfer(syntax));
  }
}

bool is_lossy(E_TransferSyntax syntax, DcmItem& dataset) {
  return syntax == EXS_JPEGProcess1 || syntax == EXS_JPEGProcess2_4 || syntax == EXS_JPEGLSLossy ||
         dicom_text(dataset, DCM_LossyImageCompression) == "01";
}

int required_short(DcmItem& dataset, const DcmTagKey& tag, const std::string& file) {
  const std::optional<int> value = dicom_unsigned_short(dataset, tag);
  if (!value) throw ConfigError(fmt::format("{} is missing", dicom_tag_name(tag)), file, kCopyAgain);
  return *value;
}

int frames_of(DcmItem& dataset, const std::string& file) {
  const std::string text = dicom_text(dataset, DCM_NumberOfFrames);
  if (text.empty()) return 1;
  const auto frames = strict_integer(text);
  if (!frames || *frames < 1 || *frames > kSizeMax)
    throw ConfigError(fmt::format("NumberOfFrames is \"{:.20}\", not a number from 1 to {}", text, kSizeMax),
                      file, kCopyAgain);
  return static_cast<int>(*frames);
}

// One stored pixel: `high_bit` down over `bits_stored` bits, two's complement where signed.
template <class Unsigned>
std::int64_t stored_value(const Uint8* bytes, const PixelFormat& format) {
  Unsigned word;
  std::memcpy(&word, bytes, sizeof(word));
  const std::uint64_t mask = (std::uint64_t{1} << format.bits_stored) - 1;
  const std::uint64_t value = (std::uint64_t{word} >> (format.high_bit + 1 - format.bits_stored)) & mask;
  const std::uint64_t sign = std::uint64_t{1} << (format.bits_stored - 1);
  return format.is_signed && (value & sign)
             ? static_cast<std::int64_t>(value) - static_cast<std::int64_t>(mask) - 1
             : static_cast<std::int64_t>(value);
}

template <class Unsigned>
double append_scaled(const std::vector<Uint8>& bytes, const PixelFormat& format, double slope,
                     double intercept, std::vector<float>& voxels) {
  double largest = 0.0;
  const std::size_t first = voxels.size();
  voxels.resize(first + format.pixels());
  float* voxel = voxels.data() + first;
  for (std::size_t n = 0; n < format.pixels(); ++n) {
    const double value =
        static_cast<double>(stored_value<Unsigned>(bytes.data() + n * sizeof(Unsigned), format)) * slope +
        intercept;
    largest = std::max(largest, std::abs(value));
    voxel[n] = static_cast<float>(value);
  }
  return largest;
}

}  // namespace

void ready_dicom_library() {
  static std::once_flag once;
  std::call_once(once, [] {
    OFLog::configure(OFLogger::OFF_LOG_LEVEL);  // what matters is said in a ConfigError
    DcmRLEDecoderRegistration::registerCodecs();
    DJDecoderRegistration::registerCodecs();
    DJLSDecoderRegistration::registerCodecs();
  });
  if (!dcmDataDict.isDictionaryLoaded())
    throw ConfigError("DCMTK's data dictionary is not loaded", "DICOM library",
                      "install the dictionary (dicom.dic) or point DCMDICTPATH at it");
}

PixelFormat read_pixel_format(DcmItem& dataset, const std::string& file) {
  PixelFormat format;
  const std::string colours = dicom_text(dataset, DCM_PhotometricInterpretation);
  if (dicom_unsigned_short(dataset, DCM_SamplesPerPixel).value_or(1) != 1)
    throw ConfigError(fmt::format("a colour image ({:.30})", colours), file,
                      "give the series as measured, in grey values");
  // MONOCHROME1 shows low values bright. A dark needle would be stored bright: read as if it were the usual
  // kind, it would mislead the search for the tip.
  if (colours != "MONOCHROME2")
    throw ConfigError(
        fmt::format("photometric interpretation \"{:.30}\" is not read, only MONOCHROME2", colours), file,
        "export the series as MONOCHROME2 (low values dark)");
  format.columns = required_short(dataset, DCM_Columns, file);
  format.rows = required_short(dataset, DCM_Rows, file);
  format.frames = frames_of(dataset, file);
  format.bits_allocated = required_short(dataset, DCM_BitsAllocated, file);
  format.bits_stored = required_short(dataset, DCM_BitsStored, file);
  format.high_bit = dicom_unsigned_short(dataset, DCM_HighBit).value_or(format.bits_stored - 1);
  const int representation = required_short(dataset, DCM_PixelRepresentation, file);
  format.is_signed = representation == 1;

  if (format.columns < 1 || format.rows < 1 || format.columns > kSizeMax || format.rows > kSizeMax)
    throw ConfigError(
        fmt::format("{} columns x {} rows is outside 1 to {}", format.columns, format.rows, kSizeMax), file,
        kCopyAgain);
  if (format.bits_allocated != 8 && format.bits_allocated != 16 && format.bits_allocated != 32)
    throw ConfigError(fmt::format("{} bits a pixel are not read, only 8, 16 or 32", format.bits_allocated),
                      file, kUncompressed);
  if (format.bits_stored < 1 || format.high_bit >= format.bits_allocated ||
      format.high_bit + 1 < format.bits_stored || representation > 1)
    throw ConfigError(
        fmt::format(
            "BitsAllocated {}, BitsStored {}, HighBit {}, PixelRepresentation {} contradict each other",
            format.bits_allocated, format.bits_stored, format.high_bit, representation),
        file, kCopyAgain);
  return format;
}

struct DicomPixels::Open {
  std::string file;
  DcmFileFormat content;
  PixelFormat format;
  DcmPixelData* pixels = nullptr;
  DcmFileCache cache;
  Uint32 fragment = 0;
  bool lossy = false;

  DcmDataset& dataset() { return *content.getDataset(); }
  void find_pixels(std::uint64_t file_bytes);
  std::vector<std::uint8_t> jpeg2000_stream(int frame);
  void append_jpeg2000(int frame, double slope, double intercept, std::vector<float>& voxels);
};

// Holds the promise of the header against what the file has, before anything of that size is allocated.
void DicomPixels::Open::find_pixels(std::uint64_t file_bytes) {
  const DcmXfer syntax(dataset().getOriginalXfer());
  if (!is_decoded(syntax.getXfer()))
    throw ConfigError(fmt::format("compressed as {}, which is not decoded", syntax.getXferName()), file,
                      kUncompressed);
  lossy = is_lossy(syntax.getXfer(), dataset());
  DcmElement* element = nullptr;
  if (dataset().findAndGetElement(DCM_PixelData, element).bad() ||
      !(pixels = dynamic_cast<DcmPixelData*>(element)))
    throw ConfigError("holds no pixel data", file, "give an image series");
  if (is_encapsulated(syntax)) return;
  // Whether the two words of such a pixel are swapped too is read differently by different writers.
  if (format.bits_allocated == 32 && syntax.isBigEndian())
    throw ConfigError("32-bit pixels in big endian are not read", file, kUncompressed);
  const std::uint64_t promised =
      static_cast<std::uint64_t>(format.frame_bytes()) * static_cast<std::uint64_t>(format.frames);
  const std::uint64_t stored = element->getLengthField();
  const bool on_disk = syntax.getStreamCompression() != ESC_none || file_bytes >= promised;
  if (stored < promised || !on_disk)
    throw ConfigError(fmt::format("truncated: {} bytes of pixels promised, {} there", promised,
                                  std::min(stored, file_bytes)),
                      file, kCopyAgain);
}

// The fragments of a frame (PS3.5 A.4): one each, or all of them where there is one frame.
std::vector<std::uint8_t> DicomPixels::Open::jpeg2000_stream(int frame) {
  const E_TransferSyntax syntax = dataset().getOriginalXfer();
  DcmPixelSequence* sequence = nullptr;
  if (pixels->getEncapsulatedRepresentation(syntax, nullptr, sequence).bad() || !sequence)
    throw ConfigError("holds no compressed pixels", file, kCopyAgain);
  const auto fragments = static_cast<int>(sequence->card()) - 1;  // the first is the table of offsets
  if (fragments < 1 || (format.frames > 1 && fragments != format.frames))
    throw ConfigError(fmt::format("{} fragments of {} frames", fragments, format.frames), file,
                      kUncompressed);
  std::vector<std::uint8_t> stream;
  const int first = format.frames > 1 ? frame : 0, last = format.frames > 1 ? frame : fragments - 1;
  for (int n = first; n <= last; ++n) {
    DcmPixelItem* item = nullptr;
    Uint8* bytes = nullptr;
    if (sequence->getItem(item, static_cast<unsigned long>(n) + 1).bad() || !item ||
        item->getUint8Array(bytes).bad() || !bytes)
      throw ConfigError(fmt::format("frame {} is missing", frame + 1), file, kCopyAgain);
    stream.insert(stream.end(), bytes, bytes + item->getLength());
  }
  return stream;
}

void DicomPixels::Open::append_jpeg2000(int frame, double slope, double intercept,
                                        std::vector<float>& voxels) {
  const std::vector<std::uint8_t> stream = jpeg2000_stream(frame);
  for (const std::int32_t value :
       decode_jpeg2000(stream, format.columns, format.rows, format.bits_stored, format.is_signed, file))
    voxels.push_back(static_cast<float>(static_cast<double>(value) * slope + intercept));
}

DicomPixels::DicomPixels(const std::filesystem::path& path) : open_(std::make_unique<Open>()) {
  ready_dicom_library();
  open_->file = path.string();
  std::error_code error;
  const std::uint64_t file_bytes = std::filesystem::file_size(path, error);
  const OFCondition loaded = open_->content.loadFile(path.c_str());
  if (error || loaded.bad())
    throw ConfigError(fmt::format("cannot be read as DICOM, truncated or damaged ({})", loaded.text()),
                      open_->file, kCopyAgain);
  open_->format = read_pixel_format(open_->dataset(), open_->file);
  open_->find_pixels(file_bytes);
}

DicomPixels::~DicomPixels() = default;

const PixelFormat& DicomPixels::format() const {
  return open_->format;
}
bool DicomPixels::lossy() const {
  return open_->lossy;
}

bool DicomPixels::append_frame(int frame, double slope, double intercept, std::vector<float>& voxels) {
  const PixelFormat& format = open_->format;
  if (is_jpeg2000(open_->dataset().getOriginalXfer())) {
    open_->append_jpeg2000(frame, slope, intercept, voxels);
    return format.bits_stored > 24;
  }
  std::vector<Uint8> bytes(format.frame_bytes() + format.frame_bytes() % 2);  // DCMTK wants an even buffer
  OFString colours;
  const OFCondition decoded = open_->pixels->getUncompressedFrame(
      &open_->dataset(), static_cast<Uint32>(frame), open_->fragment, bytes.data(),
      static_cast<Uint32>(bytes.size()), colours, &open_->cache);
  if (decoded.bad())
    throw ConfigError(
        fmt::format("frame {} cannot be decoded, truncated or damaged ({})", frame + 1, decoded.text()),
        open_->file, kCopyAgain);
  double largest = 0.0;
  switch (format.bits_allocated) {
    case 8:
      largest = append_scaled<Uint8>(bytes, format, slope, intercept, voxels);
      break;
    case 16:
      largest = append_scaled<Uint16>(bytes, format, slope, intercept, voxels);
      break;
    default:
      largest = append_scaled<Uint32>(bytes, format, slope, intercept, voxels);
      break;
  }
  return format.bits_allocated == 32 && largest > 16777216.0;
}

}  // namespace biopsy::imaging
