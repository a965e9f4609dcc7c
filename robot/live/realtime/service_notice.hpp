// Notifications of a service to systemd (protocol of sd_notify(3), without its library).
#pragma once

#include <sys/socket.h>
#include <sys/un.h>

#include <cstdint>
#include <optional>
#include <string_view>

namespace biopsy::realtime {

// Without $NOTIFY_SOCKET every call does nothing. No call waits, allocates or throws; each returns whether
// the notice was sent.
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
  // Watchdog timeout of systemd; notify twice as often. Empty: no watchdog.
  std::optional<std::int64_t> watchdog_us() const { return watchdog_us_; }

 private:
  bool send(std::string_view message) const;

  int socket_ = -1;
  sockaddr_un address_{};
  socklen_t address_size_ = 0;
  std::optional<std::int64_t> watchdog_us_;
};

}  // namespace biopsy::realtime
