#include "robot/common/text/sanitize_text.hpp"

#include <nlohmann/json.hpp>

namespace biopsy {
namespace {

// The JSON library already knows how to replace what is not UTF-8 (DICOM names may be Latin-1 or worse).
std::string valid_utf8(std::string_view text) {
  using nlohmann::json;
  const std::string written = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  return json::parse(written).get<std::string>();
}

// Length in bytes of the control or direction character at `at`, 0 where there is none.
std::size_t unprintable_at(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t offset) -> unsigned {
    return at + offset < text.size() ? static_cast<unsigned char>(text[at + offset]) : 0U;
  };
  if (byte(0) < 0x20 || byte(0) == 0x7F) return 1;
  if (byte(0) == 0xC2 && byte(1) >= 0x80 && byte(1) <= 0x9F) return 2;                     // C1 controls
  if (byte(0) == 0xE2 && byte(1) == 0x80 && byte(2) >= 0xA8 && byte(2) <= 0xAE) return 3;  // U+2028..202E
  if (byte(0) == 0xE2 && byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9) return 3;  // U+2066..2069
  if (byte(0) == 0xEF && byte(1) == 0xBF && byte(2) >= 0xBE) return 3;                     // U+FFFE, U+FFFF
  return 0;
}

}  // namespace

std::string plain(std::string_view text) {
  const std::string valid = valid_utf8(text);
  std::string shown;
  for (std::size_t at = 0; at < valid.size();) {
    const std::size_t skipped = unprintable_at(valid, at);
    shown += skipped ? ' ' : valid[at];
    at += skipped ? skipped : 1;
  }
  return shown;
}

std::string escaped(std::string_view text) {
  std::string shown;
  for (const char letter : plain(text)) switch (letter) {
      case '&':
        shown += "&amp;";
        break;
      case '<':
        shown += "&lt;";
        break;
      case '>':
        shown += "&gt;";
        break;
      case '"':
        shown += "&quot;";
        break;
      case '\'':
        shown += "&#39;";
        break;
      default:
        shown += letter;
    }
  return shown;
}

std::string person_name(std::string_view dicom_name) {
  std::string name = plain(dicom_name);
  const std::size_t family_end = name.find('^');
  if (family_end == std::string::npos) return name;
  name.replace(family_end, 1, ", ");
  for (char& letter : name)
    if (letter == '^') letter = ' ';
  while (!name.empty() && (name.back() == ' ' || name.back() == ',')) name.pop_back();
  return name;
}

}  // namespace biopsy
