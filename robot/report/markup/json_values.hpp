// Values as the JSON files of the reports hold them.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace biopsy::report {

using Json = nlohmann::ordered_json;

// Not rounded: a parameter may be 2e-9. Null where the number is not finite.
inline Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

inline Json json_text(const std::string& value) {
  return value.empty() ? Json(nullptr) : Json(value);
}

template <class Values, class Written>
Json json_list(const Values& values, Written written) {
  Json list = Json::array();
  for (const auto& value : values) list.push_back(written(value));
  return list;
}

// The file's text; what is not UTF-8 is replaced.
inline std::string json_file(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace biopsy::report
