#include "robot/common/text/sanitize_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>

namespace biopsy {
namespace {

// The JSON library already knows how to replace what is not UTF-8 (DICOM names may be Latin-1 or worse).
std::string valid_utf8(std::string_view text) {
  using nlohmann::json;
  const std::string written = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  return json::parse(written).get<std::string>();
}

struct Range {
  std::uint32_t first, last;
};

// What is not seen, or turns or moves what is: Unicode's controls (Cc), format characters (Cf), line and
// paragraph separators and default-ignorable code points (DerivedCoreProperties.txt), and the two blanks that
// are none.
constexpr std::array kUnseen{
    Range{0x0000, 0x001F},   Range{0x007F, 0x009F},   Range{0x00AD, 0x00AD},   Range{0x034F, 0x034F},
    Range{0x0600, 0x0605},   Range{0x061C, 0x061C},   Range{0x06DD, 0x06DD},   Range{0x070F, 0x070F},
    Range{0x0890, 0x0891},   Range{0x08E2, 0x08E2},   Range{0x115F, 0x1160},   Range{0x17B4, 0x17B5},
    Range{0x180B, 0x180F},   Range{0x200B, 0x200F},   Range{0x2028, 0x202E},   Range{0x2060, 0x206F},
    Range{0x2800, 0x2800},   Range{0x3164, 0x3164},   Range{0xFE00, 0xFE0F},   Range{0xFEFF, 0xFEFF},
    Range{0xFFA0, 0xFFA0},   Range{0xFFF0, 0xFFFB},   Range{0xFFFE, 0xFFFF},   Range{0x110BD, 0x110BD},
    Range{0x110CD, 0x110CD}, Range{0x13430, 0x1345F}, Range{0x1BCA0, 0x1BCA3}, Range{0x1D173, 0x1D17A},
    Range{0xE0000, 0xE0FFF}};

// Of valid UTF-8: the bytes of the character that begins at `at`, and its code point.
std::size_t length_at(std::string_view text, std::size_t at) {
  const auto first = static_cast<unsigned char>(text[at]);
  return first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
}

std::uint32_t code_point(std::string_view character) {
  constexpr std::array<std::uint32_t, 5> kFirstBits{0, 0x7F, 0x1F, 0x0F, 0x07};
  std::uint32_t code = static_cast<unsigned char>(character[0]) & kFirstBits[character.size()];
  for (const char byte : character.substr(1)) code = code << 6 | (static_cast<unsigned char>(byte) & 0x3FU);
  return code;
}

bool is_unseen(std::uint32_t code) {
  return std::ranges::any_of(kUnseen, [&](Range range) { return code >= range.first && code <= range.last; });
}

}  // namespace

std::string plain(std::string_view text) {
  const std::string valid = valid_utf8(text);
  std::string shown;
  for (std::size_t at = 0; at < valid.size();) {
    const std::string_view character = std::string_view(valid).substr(at, length_at(valid, at));
    shown += is_unseen(code_point(character)) ? " " : character;
    at += character.size();
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
