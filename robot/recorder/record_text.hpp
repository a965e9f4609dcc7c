// A record in words, for a person who reads the log. What is hashed is the record's body, not this.
#pragma once

#include <string>

#include "robot/recorder/record.hpp"

namespace biopsy::recorder {

// Who is signed in at the console, by the records so far. A key on the device names nobody: the log can only
// say who was there.
class SignedIn {
 public:
  // Every record, in order.
  void follow(const Record& record);
  // Empty: nobody, or it is not known.
  const std::string& name() const { return name_; }

 private:
  std::string name_;
};

// One line. A body that is not what its kind has is returned as it stands. `signed_in`: when it was written.
std::string text_of(const Record& record, const std::string& signed_in = "");

}  // namespace biopsy::recorder
