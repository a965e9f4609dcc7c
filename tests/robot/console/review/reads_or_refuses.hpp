// Each text that one wrong byte makes of a whole one, and each of its beginnings.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "robot/common/config_error.hpp"

namespace biopsy::console {

// `read` reads each of them or throws a ConfigError that says what is wrong, where, and what to do.
template <class Read>
void every_spoilt_text_is_read_or_refused(const std::string& whole, Read read) {
  std::size_t refusals = 0;
  const auto attempt = [&](const std::string& text) {
    try {
      read(text);
    } catch (const ConfigError& refused) {
      ++refusals;
      EXPECT_FALSE(refused.what_is_wrong.empty() || refused.where.empty() || refused.remedy.empty()) << text;
    }
  };
  for (std::size_t n = 0; n < whole.size(); ++n) {
    attempt(whole.substr(0, n));
    for (const char other : {'\0', '"', '{', ',', '\n', '-', '9', '\xff'}) {
      std::string changed = whole;
      changed[n] = other;
      attempt(changed);
    }
  }
  EXPECT_GT(refusals, whole.size()) << "hardly any of them was found to be wrong";
}

}  // namespace biopsy::console
