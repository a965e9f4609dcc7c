// Sees who is on the wire of a secured bus and does not belong there. The secured participants neither hear
// nor notice a stranger, so somebody has to look: a plain participant that reads and writes nothing. It sees
// every participant, since those are announced openly, and the endpoints of plain ones; those of the secured
// ones are announced under their protection.
#pragma once

#include "robot/transport/bus.hpp"

namespace biopsy::transport {

class ParticipantMonitor {
 public:
  // `plain`: the wire without security, under a domain id of its own in this process. `secured`: of the bus;
  // must outlive this. Throws ConfigError.
  ParticipantMonitor(const BusSettings& plain, const Participant& secured);

  // Writers and readers that belong to nobody with a key, now.
  int unauthenticated_endpoints() const;
  // Participants that the bus did not let in, now: with no keys, or with keys that are not believed. A friend
  // is one of them until it has been let in, which takes a second or two.
  int unauthenticated_participants() const;

 private:
  Entity domain_, participant_, writers_, readers_, present_;
  Entity secured_writers_, secured_readers_;
};

}  // namespace biopsy::transport
