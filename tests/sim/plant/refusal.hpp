// What a reader says when it refuses.
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

inline void expect_says(const std::string& said, const std::string& place, const std::string& reason) {
  EXPECT_EQ(said.rfind(place, 0), 0U) << said << "\n  should begin with " << place;
  EXPECT_NE(said.find(reason), std::string::npos) << said << "\n  should say " << reason;
  EXPECT_EQ(said.find("[]"), std::string::npos) << said << "\n  should say what to do";
}

}  // namespace biopsy::sim
