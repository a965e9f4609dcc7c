// What a service tells systemd about itself (the protocol of sd_notify, without its library).
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace biopsy::realtime {

// Started by nobody who listens ($NOTIFY_SOCKET unset), every call does nothing. No call waits, allocates or
// throws; each says whether the notice was handed over.
class ServiceNotice {
 public:
  // Reads $NOTIFY_SOCKET and $WATCHDOG_USEC. Throws ConfigError if one of them is set and makes no sense.
  ServiceNotice();
  ~ServiceNotice();
  ServiceNotice(const ServiceNotice&) = delete;
  ServiceNotice& operator=(const ServiceNotice&) = delete;

  bool ready() const { return send("READY=1"); }
  bool stopping() const { return send("STOPPING=1"); }
  bool watchdog() const { return send("WATCHDOG=1"); }
  bool status(std::string_view text) const;  // one line, cut at 200 characters or its first line break

  bool anybody_listens() const { return socket_ >= 0; }
  // How long systemd waits for a watchdog() before it kills; tell it twice as often. Empty: it does not wait.
  std::optional<std::int64_t> watchdog_us() const { return watchdog_us_; }

 private:
  bool send(std::string_view message) const;

  int socket_ = -1;
  sockaddr_un address_{};
  socklen_t address_size_ = 0;
  std::optional<std::int64_t> watchdog_us_;
};

}  // namespace biopsy::realtime
