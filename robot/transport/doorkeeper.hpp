// Sees who speaks or listens on the wire of a secured bus without a key. The secured participants neither
// hear nor notice such a stranger, so somebody has to look: a plain participant that reads and writes
// nothing. It sees plain endpoints only; those of the secured participants are announced under their
// protection.
#pragma once

#include "robot/transport/bus.hpp"

namespace biopsy::transport {

class Doorkeeper {
 public:
  // `plain`: the wire without security, under a domain id of its own in this process. Throws SetupError.
  explicit Doorkeeper(const BusSettings& plain);

  // Writers and readers that belong to nobody with a key, now.
  int strange_endpoints() const;

 private:
  Entity domain_, participant_, writers_, readers_;
};

}  // namespace biopsy::transport
