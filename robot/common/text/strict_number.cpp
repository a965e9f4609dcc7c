#include "robot/common/text/strict_number.hpp"

#include <charconv>
#include <cmath>

namespace biopsy {
namespace {

template <class Number>
std::optional<Number> whole_text(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text.front() == '+' && text[1] != '-')
    text.remove_prefix(1);  // from_chars knows no plus
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::string_view blanks(" \t\r\n\0", 5);  // DICOM pads with blanks and with zero bytes
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::optional<double> strict_number(std::string_view text) {
  const std::optional<double> number = whole_text<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

std::optional<std::int64_t> strict_integer(std::string_view text) {
  return whole_text<std::int64_t>(text);
}

std::optional<std::vector<double>> strict_numbers(std::string_view text, char separator) {
  std::vector<double> numbers;
  for (text = trimmed(text); !text.empty();) {
    const std::size_t end = text.find(separator);
    const std::optional<double> number = strict_number(text.substr(0, end));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    if (end == std::string_view::npos) return numbers;
    text.remove_prefix(end + 1);
    if (separator == ' ') text = trimmed(text);
    if (text.empty()) return std::nullopt;  // ends with a separator
  }
  return numbers;
}

}  // namespace biopsy
