// Which requests the server accepts. It listens on this machine only, but any page in the browser and any
// program of another user can reach it there. So a request must name this server, come from its own page, and
// carry the token that was printed at the start.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace biopsy::console {

struct Request {
  std::string_view host, origin, target;  // headers as sent (empty: none), path with query
};

class OriginPolicy {
 public:
  OriginPolicy(std::uint16_t port, std::string token) : port_(port), token_(std::move(token)) {}

  // Host is this server (DNS rebinding: another name that resolves to this machine is not), Origin its own or
  // absent.
  bool is_addressed_to_us(const Request& request) const;
  // Origin is present and its own: browsers do not stop WebSockets of other pages.
  bool is_from_our_page(const Request& request) const;
  bool has_token(const Request& request) const;

 private:
  std::uint16_t port_;
  std::string token_;
};

// 32 random hexadecimal digits. Throws ConfigError where the system has no randomness.
std::string new_token();

// Port and token of a page's address as HttpServer::url() gives it; none: it is no such address.
struct Address {
  std::uint16_t port = 0;
  std::string token;
};
std::optional<Address> address_of(std::string_view url);

// Messages of one client: a short burst, then a constant rate.
class RateLimit {
 public:
  bool allows(std::int64_t now_us);

 private:
  static constexpr double kPerSecond = 100.0, kBurst = 200.0;
  double left_ = kBurst;
  std::int64_t last_us_ = 0;
};

}  // namespace biopsy::console
