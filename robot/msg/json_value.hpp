// Values of messages as JSON for viewers: enumerators by name, 64-bit numbers as texts, since JavaScript does
// not hold them.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>

#include "robot/msg/enum_traits.hpp"

namespace biopsy {

template <class Value>
nlohmann::ordered_json json_value(const Value& value) {
  if constexpr (std::is_enum_v<Value>)
    return std::string(name_of(value));
  else if constexpr (std::is_same_v<Value, std::uint64_t>)
    return std::to_string(value);
  else
    return value;
}

template <class Value, std::size_t Count>
nlohmann::ordered_json json_value(const std::array<Value, Count>& values) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Value& value : values) list.push_back(json_value(value));
  return list;
}

}  // namespace biopsy
