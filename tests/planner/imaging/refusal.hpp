// What a reader says when it refuses, as one text: where, what, what to do.
#pragma once

#include <filesystem>
#include <string>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

inline std::string refusal_of(const std::filesystem::path& path, const std::string& series_uid = "") {
  try {
    read_volume(path, series_uid);
  } catch (const ConfigError& refusal) {
    return refusal.where + ": " + refusal.what_is_wrong +
           (refusal.remedy.empty() ? "" : " [" + refusal.remedy + "]");
  }
  return "accepted";
}

}  // namespace biopsy::imaging

// Refused, with the reason in it, the file in it and something to do.
#define EXPECT_REFUSED(path, file, reason)                      \
  do {                                                          \
    const std::string said = biopsy::imaging::refusal_of(path); \
    EXPECT_NE(said.find(reason), std::string::npos) << said;    \
    EXPECT_NE(said.find(file), std::string::npos) << said;      \
    EXPECT_EQ(said.back(), ']') << said;                        \
  } while (false)
