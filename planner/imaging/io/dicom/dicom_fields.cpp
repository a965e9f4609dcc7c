#include "planner/imaging/io/dicom/dicom_fields.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "robot/common/config_error.hpp"
#include "robot/common/text/sanitize_text.hpp"
#include "robot/common/text/strict_number.hpp"

namespace biopsy::imaging {

std::string dicom_tag_name(const DcmTagKey& tag) {
  return DcmTag(tag).getTagName();
}

std::string dicom_text(DcmItem& item, const DcmTagKey& tag) {
  OFString value;
  if (item.findAndGetOFStringArray(tag, value).bad()) return {};
  std::string text(trimmed(std::string_view(value.c_str(), value.size())));
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text;
}

std::optional<std::vector<double>> dicom_numbers(DcmItem& item, const DcmTagKey& tag, std::size_t count,
                                                 const std::string& file) {
  const std::string text = dicom_text(item, tag);
  if (text.empty()) return std::nullopt;
  auto numbers = strict_numbers(text, '\\');
  if (!numbers || numbers->size() != count)
    throw ConfigError(fmt::format("{} is \"{:.80}\", not {} number{}", dicom_tag_name(tag), plain(text),
                                  count, count == 1 ? "" : "s"),
                      file, "export the series again with its original headers");
  return numbers;
}

std::vector<double> required_dicom_numbers(DcmItem& item, const DcmTagKey& tag, std::size_t count,
                                           const std::string& file) {
  const auto numbers = dicom_numbers(item, tag, count, file);
  if (!numbers)
    throw ConfigError(
        fmt::format("{} is missing: the image cannot be placed in the scanner", dicom_tag_name(tag)), file,
        "export the original series from the scanner, not a secondary capture");
  return *numbers;
}

std::optional<int> dicom_unsigned_short(DcmItem& item, const DcmTagKey& tag) {
  Uint16 value = 0;
  if (item.findAndGetUint16(tag, value).bad()) return std::nullopt;
  return value;
}

DcmItem* dicom_first_item(DcmItem& item, const DcmTagKey& sequence) {
  DcmItem* first = nullptr;
  return item.findAndGetSequenceItem(sequence, first, 0).good() ? first : nullptr;
}

}  // namespace biopsy::imaging
