#include "sim/effects/effect_labels.hpp"

#include <array>
#include <utility>
#include <vector>

namespace biopsy::sim {
namespace {

constexpr std::array<std::pair<std::string_view, std::string_view>, 24> kUnits{
    {{"N", "N"},    {"mN", "mN"},  {"kN", "kN"},   {"m", "m"},      {"mm", "mm"},    {"um", "µm"},
     {"s", "s"},    {"ms", "ms"},  {"Hz", "Hz"},   {"V", "V"},      {"kV", "kV"},    {"kg", "kg"},
     {"g", "g"},    {"Pa", "Pa"},  {"kPa", "kPa"}, {"deg", "deg"},  {"rad", "rad"},  {"percent", "%"},
     {"s2", "s^2"}, {"m2", "m^2"}, {"m3", "m^3"},  {"mm2", "mm^2"}, {"mm3", "mm^3"}, {"V2", "V^2"}}};

std::string_view symbol_of(std::string_view word) {
  for (const auto& [name, symbol] : kUnits)
    if (name == word) return symbol;
  return {};
}

std::vector<std::string_view> words_of(std::string_view name) {
  std::vector<std::string_view> words;
  for (std::size_t end = name.find('_'); end != std::string_view::npos; end = name.find('_')) {
    words.push_back(name.substr(0, end));
    name.remove_prefix(end + 1);
  }
  words.push_back(name);
  return words;
}

bool is_product(std::string_view first) {  // N_s is N s; mm_s and kV_ms are rates
  return first == "N" || first == "mN" || first == "Pa" || first == "kg" || first == "g";
}

}  // namespace

std::string_view name_of(Attachment attachment) {
  constexpr std::array kNames{"electrical", "pouch", "stage", "tissue", "sensor"};
  return kNames[static_cast<std::size_t>(attachment)];
}

std::string_view name_of(Role role) {
  constexpr std::array kNames{"strength", "shape", "place", "level", "frequency", "phase"};
  return kNames[static_cast<std::size_t>(role)];
}

std::string unit_of(std::string_view parameter) {
  const std::vector<std::string_view> words = words_of(parameter);
  std::size_t begin = words.size();  // of the unit; a name has at least one word before it
  while (begin > 1 && (words[begin - 1] == "per" || !symbol_of(words[begin - 1]).empty())) --begin;
  std::string unit;
  bool divided = false, fresh = true;
  for (std::size_t i = begin; i < words.size(); ++i) {
    if (words[i] == "per") {
      unit += divided ? " per " : "/";
      divided = fresh = true;
      continue;
    }
    if (!fresh) unit += is_product(words[begin]) || divided ? " " : "/";
    unit += symbol_of(words[i]);
    fresh = false;
  }
  return unit;
}

}  // namespace biopsy::sim
