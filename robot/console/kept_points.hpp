// Series and points that were set at the console, and a STOP that stands, kept over a restart of it. What is
// read back goes the way of any command of a page, and a person confirms the plan anew.
#pragma once

#include <filesystem>
#include <vector>

#include "robot/console/operator_session.hpp"

namespace biopsy::robot {

// Written when they change.
class KeptPoints {
 public:
  explicit KeptPoints(std::filesystem::path file) : file_(std::move(file)) {}

  // Into a session that is new. A file that cannot be read, or whose points do not lie in this case's image,
  // is as none.
  void restore(OperatorSession& session);
  // Call after each change of the session. Throws ConfigError where the file cannot be written.
  void update(const OperatorSession& session);

 private:
  std::filesystem::path file_;
  std::string kept_;  // content of the file
};

}  // namespace biopsy::robot
