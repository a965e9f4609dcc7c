// The one translation unit that sees Boost.Beast: it takes half a minute to compile.
#include "robot/console/server/http_server.hpp"

#include <fmt/format.h>

#include <utility>  // Asio of Boost 1.74 forgets it
//
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <map>
#include <thread>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/console/server/gzip.hpp"
#include "robot/console/server/origin_policy.hpp"

namespace biopsy::console {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
namespace fs = std::filesystem;
using Tcp = asio::ip::tcp;
using Error = beast::error_code;

constexpr std::size_t kHeaderMax_bytes = 8'192, kMessageMax_bytes = 4'096, kClientsMax = 8,
                      kHttpSessionsMax = 64, kUnread_bytes = 1'000'000;
constexpr std::chrono::seconds kRequestMax{5}, kPing{2};
constexpr std::chrono::seconds kAnswerMax{60};  // a volume of 200 MB to a busy page

// Scripts, styles, images and connections of this server only.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self' "
    "data:; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr const char* kSelfContainedPolicy =
    "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'";

std::int64_t now_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(now).count();
}

std::string media_type_of(const fs::path& file) {
  static const std::map<std::string, std::string> kTypes{{".html", "text/html; charset=utf-8"},
                                                         {".js", "text/javascript"},
                                                         {".css", "text/css"},
                                                         {".svg", "image/svg+xml"},
                                                         {".png", "image/png"},
                                                         {".json", "application/json"},
                                                         {".txt", "text/plain; charset=utf-8"},
                                                         {".woff2", "font/woff2"}};
  const auto found = kTypes.find(file.extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// Read once: no request can name another file.
std::map<std::string, Document> read_page(const fs::path& folder, const std::string& start) {
  std::map<std::string, Document> page;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    const auto body = std::make_shared<const std::string>(read_file(entry.path()));
    page["/" + fs::relative(entry.path(), folder).generic_string()] = {
        media_type_of(entry.path()), body, false, std::make_shared<const std::string>(gzip(*body))};
  }
  if (!page.contains("/" + start))
    throw ConfigError("the console's page does not exist", (folder / start).string(),
                      "build it: ./dev console");
  page["/"] = page["/" + start];
  return page;
}

}  // namespace

class HttpSession;
class WebSocketSession;

struct HttpState {
  HttpState(const fs::path& page_folder, const std::string& start, std::string token_text,
            ServerCallbacks given)
      : page(read_page(page_folder, start)), token(std::move(token_text)), callbacks(std::move(given)) {}

  void listen(std::uint16_t wanted);
  void accept();

  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  std::map<std::string, Document> page;
  std::string token;
  std::uint16_t port = 0;
  std::unique_ptr<OriginPolicy> policy;
  ServerCallbacks callbacks;
  Client last_client = 0;
  std::size_t http_sessions = 0;
  std::map<Client, std::shared_ptr<WebSocketSession>> web_sockets;
  std::thread thread;
};

// A page with its WebSocket.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(Tcp::socket socket, HttpState& state, Client client)
      : socket_(std::move(socket)), state_(state), client_(client) {}

  void accept(const http::request<http::string_body>& request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestMax;
    timeout.idle_timeout = 2 * kPing;  // Beast pings at half of it
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(kMessageMax_bytes);
    socket_.next_layer().set_option(Tcp::no_delay(true));
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (error) return self->disconnect();
      self->accepted_ = true;
      self->state_.callbacks.connected(self->client_);
      self->read();
    });
  }

  // Dropped before the handshake is answered: a page is told all once it is connected.
  void send(SendQueue::Text text, Reliability reliability) {
    if (!accepted_) return;
    const bool idle = queue_.empty();
    queue_.push(std::move(text), reliability);
    if (queue_.overflows()) return close();
    if (idle && !queue_.empty()) write();
  }

  void close() {
    Error ignored;
    socket_.next_layer().close(ignored);
  }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->disconnect();
      const std::string text = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      if (!self->rate_.allows(now_us())) return self->disconnect();
      self->state_.callbacks.received(self->client_, text);
      self->read();
    });
  }

  void write() {
    socket_.text(true);
    socket_.async_write(asio::buffer(queue_.front()), [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->disconnect();
      self->queue_.pop();
      if (!self->queue_.empty()) self->write();
    });
  }

  void disconnect() {
    if (std::exchange(disconnected_, true)) return;
    close();
    state_.web_sockets.erase(client_);
    state_.callbacks.disconnected(client_);
  }

  websocket::stream<Tcp::socket> socket_;
  HttpState& state_;
  Client client_;
  beast::flat_buffer buffer_;
  SendQueue queue_;
  RateLimit rate_;
  bool accepted_ = false, disconnected_ = false;
};

// One HTTP request, answered and closed, or made a WebSocketSession.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Tcp::socket socket, HttpState& state) : stream_(std::move(socket)), state_(state) {
    ++state_.http_sessions;
    parser_.header_limit(kHeaderMax_bytes);
    parser_.body_limit(0);
  }
  ~HttpSession() { --state_.http_sessions; }

  void serve() {
    stream_.expires_after(kRequestMax);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (error == http::error::body_limit) return self->refuse(http::status::payload_too_large, "GET only");
      if (!error) self->answer();
    });
  }

 private:
  void answer() {
    const auto& received = parser_.get();
    const auto header = [&](http::field name) {
      const auto value = received[name];
      return std::string_view(value.data(), value.size());
    };
    const std::string_view target(received.target().data(), received.target().size());
    const Request request{header(http::field::host), header(http::field::origin), target};
    if (!state_.policy->is_addressed_to_us(request))
      return refuse(http::status::forbidden, "not this server");
    const std::string path(target.substr(0, target.find('?')));
    if (websocket::is_upgrade(received)) return upgrade(request, path);
    if (received.method() != http::verb::get) return refuse(http::status::method_not_allowed, "GET only");
    if (const auto file = state_.page.find(path); file != state_.page.end()) return send(file->second);
    if (!state_.policy->has_token(request)) return refuse(http::status::forbidden, "no token");
    if (path == "/status")  // why a page gets no WebSocket
      return state_.web_sockets.size() >= kClientsMax
                 ? refuse(http::status::service_unavailable, "too many pages")
                 : refuse(http::status::ok, "ready");
    if (const auto made = state_.callbacks.document(path)) return send(*made);
    refuse(http::status::not_found, "no such page");
  }

  void upgrade(const Request& request, const std::string& path) {
    if (!state_.callbacks.connected || path != "/live" || !state_.policy->is_from_our_page(request) ||
        !state_.policy->has_token(request))
      return refuse(http::status::forbidden, "not this page, or no token");
    if (state_.web_sockets.size() >= kClientsMax)
      return refuse(http::status::service_unavailable, "too many pages");
    stream_.expires_never();
    const Client client = ++state_.last_client;
    const auto session = std::make_shared<WebSocketSession>(stream_.release_socket(), state_, client);
    state_.web_sockets[client] = session;
    session->accept(parser_.get());
  }

  void refuse(http::status status, const char* why) {
    status_ = status;
    send({"text/plain", std::make_shared<const std::string>(why)});
  }

  void send(const Document& document) {
    const std::string_view accepted(parser_.get()[http::field::accept_encoding].data(),
                                    parser_.get()[http::field::accept_encoding].size());
    const bool compressed = document.gzipped && accepted.find("gzip") != std::string_view::npos;
    body_ = compressed ? document.gzipped : document.body;
    response_.emplace(std::piecewise_construct, std::make_tuple(body_->data(), body_->size()),
                      std::make_tuple(status_, 11u));
    auto& response = *response_;
    response.set(http::field::content_type, document.media_type);
    response.set("Content-Security-Policy", document.self_contained ? kSelfContainedPolicy : kContentPolicy);
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set(http::field::cache_control, "no-store");
    if (document.gzipped) response.set(http::field::vary, "Accept-Encoding");
    if (compressed) response.set(http::field::content_encoding, "gzip");
    response.keep_alive(false);
    response.prepare_payload();
    stream_.expires_after(kAnswerMax);
    http::async_write(stream_, response, [self = shared_from_this()](Error, std::size_t) {
      Error ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
      self->left_ = kUnread_bytes;
      self->stream_.expires_after(kRequestMax);
      self->drain();
    });
  }

  // What the client still sends is read and dropped: closed before, the answer could be lost.
  void drain() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kHeaderMax_bytes),
                            [self = shared_from_this()](Error error, std::size_t read) {
                              if (error || read > self->left_) return;
                              self->left_ -= read;
                              self->drain();
                            });
  }

  beast::tcp_stream stream_;
  HttpState& state_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::status status_ = http::status::ok;
  std::size_t left_ = 0;
  std::shared_ptr<const std::string> body_;
  std::optional<http::response<http::span_body<const char>>> response_;
};

void HttpState::listen(std::uint16_t wanted) {
  const Tcp::endpoint here(asio::ip::make_address("127.0.0.1"), wanted);
  Error error;
  acceptor.open(here.protocol());
  acceptor.set_option(asio::socket_base::reuse_address(true));
  acceptor.bind(here, error);
  if (!error) acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw ConfigError(fmt::format("cannot listen: {}", error.message()), fmt::format("127.0.0.1:{}", wanted),
                      "another --port, or 0 for any that is free");
  port = acceptor.local_endpoint().port();
  policy = std::make_unique<OriginPolicy>(port, token);
}

void HttpState::accept() {
  acceptor.async_accept([this](Error error, Tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error && http_sessions < kHttpSessionsMax)
      std::make_shared<HttpSession>(std::move(socket), *this)->serve();
    accept();
  });
}

HttpServer::HttpServer(const fs::path& page, std::uint16_t port, std::string token, ServerCallbacks callbacks,
                       const std::string& start)
    : state_(std::make_unique<HttpState>(page, start, std::move(token), std::move(callbacks))) {
  state_->listen(port);
  state_->accept();
  state_->thread = std::thread([this] { state_->io.run(); });
}

HttpServer::~HttpServer() {
  state_->io.stop();
  state_->thread.join();
  for (const auto& [client, session] : std::exchange(state_->web_sockets, {})) session->close();
}

std::string HttpServer::url() const {
  return fmt::format("http://127.0.0.1:{}/?t={}", state_->port, state_->token);
}

void HttpServer::send(Client client, SendQueue::Text text, Reliability reliability) {
  asio::post(state_->io, [this, client, text = std::move(text), reliability] {
    const auto found = state_->web_sockets.find(client);
    if (found != state_->web_sockets.end()) found->second->send(text, reliability);
  });
}

void HttpServer::send_to_all(SendQueue::Text text, Reliability reliability) {
  asio::post(state_->io, [this, text = std::move(text), reliability] {
    for (const auto& [client, session] : std::map(state_->web_sockets)) session->send(text, reliability);
  });
}

}  // namespace biopsy::console
