// Detects unauthenticated participants on the network of a secured bus. Secured participants are not notified
// of them, so this one joins without security and reads discovery only: participants are announced in clear,
// endpoints of secured ones are not.
#pragma once

#include "robot/transport/bus.hpp"

namespace biopsy::transport {

class ParticipantMonitor {
 public:
  // `plain`: the network without security, under a domain id of its own in this process. `secured`: a
  // participant of the bus; must outlive this. Throws ConfigError.
  ParticipantMonitor(const BusSettings& plain, const Participant& secured);

  // Writers and readers announced in clear now, other than this one's.
  int unauthenticated_endpoints() const;
  // Participants present now that are not authenticated: no keys, or keys that were rejected. An authorised
  // one counts until its handshake is done, which takes a second or two.
  int unauthenticated_participants() const;

 private:
  Entity domain_, participant_, writers_, readers_, present_;
  Entity secured_writers_, secured_readers_;
};

}  // namespace biopsy::transport
