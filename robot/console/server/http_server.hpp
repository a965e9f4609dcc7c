// The web server of the console: files of the page, documents generated on request, and one WebSocket for
// each page. Listens on 127.0.0.1 only and accepts what OriginPolicy accepts. Independent of the robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "robot/console/server/lease.hpp"
#include "robot/console/server/send_queue.hpp"

namespace biopsy::console {

struct Document {
  std::string media_type;
  std::shared_ptr<const std::string> body;
  bool self_contained = false;                           // has its own style, no script and no link
  std::shared_ptr<const std::string> gzipped = nullptr;  // the same, for browsers that take it
};

// Called on the server's thread. Without `connected` there are no WebSockets.
struct ServerCallbacks {
  std::function<void(Client)> connected;
  std::function<void(Client, const std::string&)> received;
  std::function<void(Client)> disconnected;
  // For what is not a file of the page; path without the query.
  std::function<std::optional<Document>(const std::string& path)> document;
};

struct HttpState;

class HttpServer {
 public:
  // `page`: folder of the built page, read once; `start`: the file of it that `/` is. Port 0: a free one.
  // Throws ConfigError: no page, port in use.
  HttpServer(const std::filesystem::path& page, std::uint16_t port, std::string token,
             ServerCallbacks callbacks, const std::string& start = "index.html");
  ~HttpServer();

  std::string url() const;  // with the token: its bearer may control
  // From any thread; nothing happens for a client that has disconnected.
  void send(Client client, SendQueue::Text text, Reliability reliability);
  void send_to_all(SendQueue::Text text, Reliability reliability);

 private:
  std::unique_ptr<HttpState> state_;
};

}  // namespace biopsy::console
