// Text of a refusal.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "robot/common/config_error.hpp"

namespace biopsy::sim {

// Where, what and what to do, as one text; "accepted" where nothing was refused.
template <class Read>
std::string refusal(Read&& read) {
  try {
    read();
  } catch (const ConfigError& error) {
    return error.where + ": " + error.what_is_wrong + " [" + error.remedy + "]";
  }
  return "accepted";
}

inline void expect_refusal(const std::string& text, const std::string& place, const std::string& reason) {
  EXPECT_EQ(text.rfind(place, 0), 0U) << text << "\n  should begin with " << place;
  EXPECT_NE(text.find(reason), std::string::npos) << text << "\n  should contain " << reason;
  EXPECT_EQ(text.find("[]"), std::string::npos) << text << "\n  should contain a remedy";
}

}  // namespace biopsy::sim
