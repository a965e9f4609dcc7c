// Whether a document tells of everything that a file for programs holds.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

namespace biopsy::stories {

// As code: `word`, `word VALUE` or [word].
inline bool mentions(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("[`\\[.]" + word + "(`|\\]| [A-Z])"));
}

inline void expect_told(const nlohmann::json& value, const std::string& reference) {
  if (value.is_object())
    for (const auto& [key, inner] : value.items()) {
      if (key != "provenance") expect_told(inner, reference);
      EXPECT_TRUE(mentions(reference, key)) << key;
    }
  if (value.is_array())
    for (const auto& inner : value) expect_told(inner, reference);
}

}  // namespace biopsy::stories
