// Who may talk to the server at all. It listens on this machine only; but every page in the browser and every
// program of another user could reach it there. So a request must name this very server, come from its own
// page, and carry the token that was printed at the start.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace biopsy::console {

struct Request {
  std::string_view host, origin, target;  // headers as sent (empty: none), path with query
};

class OriginPolicy {
 public:
  OriginPolicy(std::uint16_t port, std::string token) : port_(port), token_(std::move(token)) {}

  // Host is ours (a page of another name that resolves to this machine is not), Origin ours or absent.
  bool is_addressed_to_us(const Request& request) const;
  // Origin is present and ours: a WebSocket of another page is not stopped by the browser.
  bool is_from_our_page(const Request& request) const;
  bool has_token(const Request& request) const;

 private:
  std::uint16_t port_;
  std::string token_;
};

// 32 hexadecimal digits nobody can guess. Throws ConfigError where the system has no randomness.
std::string new_token();

// Messages of one client: a short burst, then so many a second.
class RateLimit {
 public:
  bool allows(std::int64_t now_us);

 private:
  static constexpr double kPerSecond = 100.0, kBurst = 200.0;
  double left_ = kBurst;
  std::int64_t asked_us_ = 0;
};

}  // namespace biopsy::console
