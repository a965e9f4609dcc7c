// The web server of the console: files of the page, documents made on demand, and one WebSocket a page.
// Listens on 127.0.0.1 only and lets in whom OriginPolicy let in. Knows nothing of robots.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "robot/console/server/lease.hpp"
#include "robot/console/server/outbox.hpp"

namespace biopsy::console {

struct Document {
  std::string media_type;
  std::shared_ptr<const std::string> body;
  bool self_contained = false;  // brings its own style, and neither scripts nor links to anything
};

// Called on the server's thread.
struct WebEvents {
  std::function<void(Client)> came;
  std::function<void(Client, const std::string&)> said;
  std::function<void(Client)> left;
  // What is not a file of the page; path without the query.
  std::function<std::optional<Document>(const std::string& path)> document;
};

struct HttpState;

class HttpServer {
 public:
  // `page`: folder of the built page, read once. Port 0: a free one. Throws ConfigError: no page, port in
  // use.
  HttpServer(const std::filesystem::path& page, std::uint16_t port, std::string token, WebEvents events);
  ~HttpServer();

  std::string url() const;  // with the token: whoever has it may control
  // From any thread; to a client that is gone: nothing happens.
  void send(Client client, Outbox::Text text, Worth worth);
  void send_to_all(Outbox::Text text, Worth worth);

 private:
  std::unique_ptr<HttpState> state_;
};

}  // namespace biopsy::console
