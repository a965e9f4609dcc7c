#include "robot/igtl/server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "robot/common/config_error.hpp"

namespace biopsy::igtl {

class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kReadAtOnce_bytes = 65'536;
constexpr int kAcceptAtOnce = 64, kBacklog = 64;

void set_option(int socket, int level, int name, int value) {
  setsockopt(socket, level, name, &value, sizeof value);
}

// The kernel finds a peer that has gone without a word: it is probed while nothing is sent, and what was sent
// must be acknowledged.
void find_half_open(int socket, std::chrono::seconds patience) {
  const int probes = 3, interval_s = std::max(1, static_cast<int>(patience.count()) / (probes + 1));
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, interval_s);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, interval_s);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, probes);
  // A quarter less: what is sent just before, and the stop that follows, take time too.
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, static_cast<int>(patience.count()) * 750);
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
}

[[noreturn]] void refuse_to_listen(const ServerSettings& settings, const std::string& what) {
  throw ConfigError(fmt::format("cannot listen: {}", what),
                    fmt::format("{}:{}", settings.address, settings.port),
                    "give the address of an interface of this machine and a free port");
}

Descriptor listen_on(const ServerSettings& settings) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(settings.port);
  if (inet_pton(AF_INET, settings.address.c_str(), &address.sin_addr) != 1)
    refuse_to_listen(settings, "this is no IPv4 address");
  Descriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  set_option(listener.number(), SOL_SOCKET, SO_REUSEADDR, 1);
  const bool bound = bind(listener.number(), reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  if (!bound || listen(listener.number(), kBacklog) != 0) refuse_to_listen(settings, std::strerror(errno));
  return listener;
}

}  // namespace

struct Server::Connection {
  Connection(int number, const Limits& limits) : socket(number), decoder(limits) {}

  Descriptor socket;
  Decoder decoder;
  std::vector<std::uint8_t> unsent;
  std::optional<Clock::time_point> inside_since;  // a message that is not whole yet
  Clock::time_point heard;                        // its last message; before that: connected
  Clock::time_point second;                       // in which messages are counted
  std::size_t messages = 0;
  bool has_spoken = false;
  std::string ended;  // why; empty: it has not
  bool told = false;  // that it has, as an event
};

struct Server::State {
  explicit State(const ServerSettings& given) : settings(given), listener(listen_on(given)) {}

  void accept_new(std::vector<ServerEvent>& events);
  void make_room(std::vector<ServerEvent>& events);
  void make_space(Connection& reading, std::size_t more);
  void read(Client client, Connection& connection, std::vector<ServerEvent>& events);
  void take_messages(Client client, Connection& connection, std::vector<ServerEvent>& events);
  void write(Connection& connection);
  void end(Connection& connection, const std::string& why);
  void look_at_time(Connection& connection);
  void tell_end(Client client, Connection& connection, std::vector<ServerEvent>& events);
  void bury(std::vector<ServerEvent>& events);

  ServerSettings settings;
  Descriptor listener;
  std::map<Client, Connection> connections;
  Client last_client = 0;
  std::optional<Client> kept;
  Clock::time_point now;
};

// With a STATUS that says why; who does not read it was told all the same.
void Server::State::end(Connection& connection, const std::string& why) {
  const std::vector<std::uint8_t> last =
      encode({"CURRENT_STATUS", Status{StatusCode::IllegalInstruction, "CLOSED", why}},
             std::chrono::system_clock::now());
  connection.unsent.insert(connection.unsent.end(), last.begin(), last.end());
  write(connection);
  connection.ended = why;
}

// A connection that never said anything gives way to one that may; else the one that has been silent longest.
void Server::State::make_room(std::vector<ServerEvent>& events) {
  if (connections.size() < settings.connections) return;
  const auto may_give_way = [&](const auto& one) {
    const auto& [client, connection] = one;
    return client != kept && connection.ended.empty() &&
           (!connection.has_spoken || now - connection.heard > settings.idle_gives_way);
  };
  const auto before = [](const auto& one, const auto& other) {
    return std::pair(one.second.has_spoken, one.second.heard) <
           std::pair(other.second.has_spoken, other.second.heard);
  };
  auto found = connections.end();
  for (auto one = connections.begin(); one != connections.end(); ++one)
    if (may_give_way(*one) && (found == connections.end() || before(*one, *found))) found = one;
  if (found == connections.end()) return;
  end(found->second, "silent, where others wait to connect");
  tell_end(found->first, found->second, events);
  connections.erase(found);
}

void Server::State::accept_new(std::vector<ServerEvent>& events) {
  for (int count = 0; count < kAcceptAtOnce; ++count) {
    Descriptor socket(accept4(listener.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket.number() < 0) return;
    make_room(events);
    find_half_open(socket.number(), settings.half_open);
    Connection connection(-1, settings.limits);
    connection.socket = std::move(socket);
    connection.second = connection.heard = now;
    if (connections.size() >= settings.connections) {
      end(connection, fmt::format("{} are connected, and no more can be", settings.connections));
      continue;  // closed by going out of scope
    }
    connections.emplace(++last_client, std::move(connection));
  }
}

void Server::State::take_messages(Client client, Connection& connection, std::vector<ServerEvent>& events) {
  try {
    while (auto message = connection.decoder.next()) {
      connection.inside_since.reset();
      connection.has_spoken = true;
      connection.heard = now;
      if (now - connection.second >= std::chrono::seconds(1))
        connection.second = now, connection.messages = 0;
      if (++connection.messages > settings.messages_per_s) {
        return end(connection, fmt::format("more than {} messages in a second", settings.messages_per_s));
      }
      events.push_back({client, std::move(message), {}});
    }
  } catch (const FramingLost& lost) {
    return end(connection, lost.why);
  }
  if (connection.decoder.waiting_bytes() > 0 && !connection.inside_since) connection.inside_since = now;
}

// For so many bytes more of a connection: where all messages that are not whole are too much together, the
// longest of them ends, whoever is the one to read now.
void Server::State::make_space(Connection& reading, std::size_t more) {
  const auto length = [&](const Connection& one) {
    return one.decoder.waiting_bytes() + (&one == &reading ? more : 0);
  };
  std::size_t all = 0;
  Connection* longest = &reading;
  for (auto& [client, one] : connections) {
    if (!one.ended.empty()) continue;
    all += length(one);
    if (length(one) > length(*longest)) longest = &one;
  }
  if (all > settings.received_bytes) end(*longest, "too much that is not whole yet");
}

void Server::State::read(Client client, Connection& connection, std::vector<ServerEvent>& events) {
  std::array<std::uint8_t, kReadAtOnce_bytes> bytes;
  const ssize_t count = recv(connection.socket.number(), bytes.data(), bytes.size(), 0);
  if (count < 0) {
    if (errno != EAGAIN && errno != EINTR) connection.ended = std::strerror(errno);
    return;
  }
  if (count == 0) {
    connection.ended = "closed by the peer";
    return;
  }
  make_space(connection, static_cast<std::size_t>(count));
  if (!connection.ended.empty()) return;
  connection.decoder.feed({bytes.data(), static_cast<std::size_t>(count)});
  take_messages(client, connection, events);
}

void Server::State::write(Connection& connection) {
  if (connection.unsent.empty() || !connection.ended.empty()) return;
  const ssize_t count =
      ::send(connection.socket.number(), connection.unsent.data(), connection.unsent.size(), MSG_NOSIGNAL);
  if (count < 0 && errno != EAGAIN && errno != EINTR) connection.ended = std::strerror(errno);
  if (count > 0) connection.unsent.erase(connection.unsent.begin(), connection.unsent.begin() + count);
}

void Server::State::look_at_time(Connection& connection) {
  if (!connection.ended.empty() || !connection.inside_since) return;
  const bool large = connection.decoder.waiting_bytes() > settings.limits.body_bytes;
  if (now - *connection.inside_since > (large ? settings.image_time : settings.message_time))
    end(connection, "a message that was begun did not come to its end in time");
}

// Behind what it still sent, and before what a client says that connected later: the same program, come back.
void Server::State::tell_end(Client client, Connection& connection, std::vector<ServerEvent>& events) {
  if (connection.ended.empty() || connection.told) return;
  events.push_back({client, std::nullopt, connection.ended});
  connection.told = true;
}

void Server::State::bury(std::vector<ServerEvent>& events) {
  for (auto& [client, connection] : connections) tell_end(client, connection, events);
  std::erase_if(connections, [](const auto& one) { return one.second.told; });
}

Server::Server(const ServerSettings& settings) : state_(std::make_unique<State>(settings)) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(state_->listener.number(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

std::size_t Server::connections() const {
  return state_->connections.size();
}

std::vector<ServerEvent> Server::poll(std::chrono::milliseconds timeout) {
  std::vector<pollfd> wanted{{state_->listener.number(), POLLIN, 0}};
  std::vector<Client> clients;
  for (const auto& [client, connection] : state_->connections) {
    const auto events = static_cast<short>(POLLIN | (connection.unsent.empty() ? 0 : POLLOUT));
    wanted.push_back({connection.socket.number(), events, 0});
    clients.push_back(client);
  }
  ::poll(wanted.data(), wanted.size(), static_cast<int>(timeout.count()));
  state_->now = Clock::now();
  std::vector<ServerEvent> events;
  for (std::size_t i = 0; i < clients.size(); ++i) {
    Connection& connection = state_->connections.at(clients[i]);
    if ((wanted[i + 1].revents & POLLOUT) != 0) state_->write(connection);
    if ((wanted[i + 1].revents & (POLLIN | POLLERR | POLLHUP)) != 0 && connection.ended.empty())
      state_->read(clients[i], connection, events);
    state_->look_at_time(connection);
    state_->tell_end(clients[i], connection, events);
  }
  state_->bury(events);
  if (wanted[0].revents != 0) state_->accept_new(events);
  return events;
}

void Server::send(Client client, const Message& message, bool droppable) {
  const auto found = state_->connections.find(client);
  if (found == state_->connections.end() || !found->second.ended.empty()) return;
  Connection& connection = found->second;
  if (droppable && connection.unsent.size() > state_->settings.unsent_droppable_bytes) return;
  const std::vector<std::uint8_t> bytes = encode(message, std::chrono::system_clock::now());
  connection.unsent.insert(connection.unsent.end(), bytes.begin(), bytes.end());
  if (connection.unsent.size() > state_->settings.unsent_bytes)
    connection.ended = "it does not read what it is sent";
}

void Server::keep(std::optional<Client> client) {
  state_->kept = client;
}

void Server::flush() {
  for (auto& [client, connection] : state_->connections) state_->write(connection);
}

}  // namespace biopsy::igtl
