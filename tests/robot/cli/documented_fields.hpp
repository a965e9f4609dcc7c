// Whether a document describes every field of a JSON file.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <string>

namespace biopsy::cli_tests {

// As code: `word`, `word VALUE` or [word].
inline bool mentions(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("[`\\[.]" + word + "(`|\\]| [A-Z])"));
}

inline void expect_documented(const nlohmann::json& value, const std::string& reference) {
  if (value.is_object())
    for (const auto& [key, inner] : value.items()) {
      if (key != "provenance") expect_documented(inner, reference);
      EXPECT_TRUE(mentions(reference, key)) << key;
    }
  if (value.is_array())
    for (const auto& inner : value) expect_documented(inner, reference);
}

}  // namespace biopsy::cli_tests
