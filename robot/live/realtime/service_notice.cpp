#include "robot/live/realtime/service_notice.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <string>
#include <system_error>

#include "robot/common/config_error.hpp"

namespace biopsy::realtime {
namespace {

constexpr std::size_t kLongestStatus = 200, kRoom = 256;
constexpr std::string_view kStatus = "STATUS=";
static_assert(kStatus.size() + kLongestStatus <= kRoom);

std::string_view environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? std::string_view{} : std::string_view{value};
}

std::optional<std::int64_t> number(const char* name) {
  const std::string_view text = environment(name);
  if (text.empty()) return {};
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value <= 0)
    throw ConfigError("\"" + std::string(text) + "\" is not a number above 0", std::string("$") + name,
                      "unset it, or let systemd set it");
  return value;
}

// A watchdog of another process is not ours: the variables are inherited.
std::optional<std::int64_t> watchdog_period() {
  const std::optional<std::int64_t> process = number("WATCHDOG_PID");
  return process && *process != ::getpid() ? std::nullopt : number("WATCHDOG_USEC");
}

}  // namespace

ServiceNotice::ServiceNotice() : watchdog_us_(watchdog_period()) {
  const std::string_view name = environment("NOTIFY_SOCKET");
  if (name.empty()) return;
  if ((name[0] != '/' && name[0] != '@') || name.size() < 2 || name.size() >= sizeof address_.sun_path)
    throw ConfigError("is neither a path nor an abstract name (@...) of a socket", "$NOTIFY_SOCKET",
                      "unset it, or let systemd set it");
  address_.sun_family = AF_UNIX;
  std::memcpy(address_.sun_path, name.data(), name.size());
  if (name[0] == '@') address_.sun_path[0] = '\0';
  address_size_ = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size());
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0)
    throw ConfigError("no socket: " + std::generic_category().message(errno), "$NOTIFY_SOCKET",
                      "raise the limit of open files");
}

ServiceNotice::~ServiceNotice() {
  if (socket_ >= 0) ::close(socket_);
}

bool ServiceNotice::status(std::string_view text) const {
  const std::size_t size = std::min({text.size(), text.find('\n'), kLongestStatus});
  std::array<char, kRoom> message{};
  const auto end = std::copy_n(text.data(), size, std::copy(kStatus.begin(), kStatus.end(), message.begin()));
  return send({message.data(), static_cast<std::size_t>(std::distance(message.begin(), end))});
}

bool ServiceNotice::send(std::string_view message) const {
  return socket_ >= 0 && ::sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL,
                                  reinterpret_cast<const sockaddr*>(&address_),
                                  address_size_) == static_cast<ssize_t>(message.size());
}

}  // namespace biopsy::realtime
