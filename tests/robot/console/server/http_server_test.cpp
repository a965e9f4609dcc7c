// The server's WebSockets against clients that speak HTTP by hand.
#include "robot/console/server/http_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "robot/console/server/origin_policy.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::console {
namespace {

// A connection to the server's port; what is received arrives within ten seconds or not at all.
class Connection {
 public:
  explicit Connection(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const timeval patience{10, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    connected_ = connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0;
  }
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void send(const std::string& text) const { (void)::send(socket_, text.data(), text.size(), MSG_NOSIGNAL); }
  std::string receive(std::size_t bytes) const {
    std::string text(bytes, '\0');
    const ssize_t got = connected_ ? recv(socket_, text.data(), bytes, MSG_WAITALL) : 0;
    text.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return text;
  }

 private:
  int socket_;
  bool connected_ = false;
};

std::string upgrade_request(const Address& server) {
  const std::string host = "127.0.0.1:" + std::to_string(server.port);
  return "GET /live?t=" + server.token + " HTTP/1.1\r\nHost: " + host + "\r\nOrigin: http://" + host +
         "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n";
}

struct Served {
  explicit Served(ServerCallbacks callbacks) {
    page.write("index.html", "<!doctype html>");
    server = std::make_unique<HttpServer>(page.path(), 0, new_token(), std::move(callbacks));
    address = *address_of(server->url());
  }
  ScratchFolder page;
  std::unique_ptr<HttpServer> server;
  Address address;
};

// What is sent to all pages is sent all the time, so also between a page's request and the answer to it.
TEST(HttpServer, SendsNothingToAPageBeforeItsHandshakeIsAnswered) {
  std::atomic<int> connected = 0;
  ServerCallbacks callbacks;
  callbacks.connected = [&](Client) { ++connected; };
  callbacks.received = [](Client, const std::string&) {};
  callbacks.disconnected = [](Client) {};
  Served served(callbacks);
  std::atomic<bool> done = false;
  std::thread sender([&] {
    const auto text = std::make_shared<const std::string>("telemetry");
    while (!done) {
      served.server->send_to_all(text, Reliability::BestEffort);
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
  });
  for (int n = 0; n < 40; ++n) {
    const Connection page(served.address.port);
    page.send(upgrade_request(served.address));
    EXPECT_EQ(page.receive(12), "HTTP/1.1 101") << n;
  }
  done = true;
  sender.join();
  EXPECT_GT(connected, 0);
}

TEST(HttpServer, WithoutCallbacksForPagesHasNoWebSockets) {
  Served served({});
  const Connection page(served.address.port);
  page.send(upgrade_request(served.address));
  EXPECT_EQ(page.receive(12), "HTTP/1.1 403");
}

}  // namespace
}  // namespace biopsy::console
