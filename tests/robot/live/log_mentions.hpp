// What a procedure log says.
#pragma once

#include <filesystem>
#include <string>

#include "robot/common/ed25519.hpp"
#include "robot/recorder/verify.hpp"

namespace biopsy::live_tests {

// Whether a record of the log in this folder has these words.
inline bool tells_of(const std::filesystem::path& folder, const std::string& words) {
  bool told = false;
  const std::filesystem::path log = folder / "procedure.log.sqlite";
  recorder::verify(log, read_public_key(log.string() + ".pub.pem"), [&](const recorder::Record& record) {
    told = told || record.body.find(words) != std::string::npos;
  });
  return told;
}

}  // namespace biopsy::live_tests
