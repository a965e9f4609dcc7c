// A set of keys for one test, gone when the test ends.
#pragma once

#include <chrono>
#include <filesystem>

#include "robot/security/make_keys.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::security {

inline std::chrono::sys_seconds now() {
  return std::chrono::time_point_cast<std::chrono::seconds>(std::chrono::system_clock::now());
}

class TestKeySet {
 public:
  explicit TestKeySet(std::chrono::sys_seconds made = now(), int days = 30) {
    make_keys(folder(), days, made, false);
  }
  std::filesystem::path folder() const { return scratch_ / "keys"; }

 private:
  ScratchFolder scratch_;
};

}  // namespace biopsy::security
