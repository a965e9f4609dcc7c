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
                      kHttpSessionsMax = 64;
constexpr std::chrono::seconds kRequestMax{5}, kPing{2};
constexpr std::chrono::seconds kAnswerMax{60};  // a volume of 200 MB to a busy page

// Nothing but what this server itself serves runs, is styled, shown or connected to.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self' "
    "data:; "
    "font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

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
                                                         {".woff2", "font/woff2"}};
  const auto found = kTypes.find(file.extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// Read once, and only what lies there now: no request can name another file.
std::map<std::string, Document> read_page(const fs::path& folder) {
  std::map<std::string, Document> page;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error)) {
    if (!entry.is_regular_file()) continue;
    page["/" + fs::relative(entry.path(), folder).generic_string()] = {
        media_type_of(entry.path()), std::make_shared<const std::string>(read_file(entry.path()))};
  }
  if (!page.contains("/index.html"))
    throw ConfigError("the console's page is not there", folder.string(), "build it: ./dev console");
  page["/"] = page["/index.html"];
  return page;
}

}  // namespace

class HttpSession;
class WebSocketSession;

struct HttpState {
  HttpState(const fs::path& page_folder, std::string token, WebEvents given)
      : page(read_page(page_folder)), key(std::move(token)), events(std::move(given)) {}

  void listen(std::uint16_t wanted);
  void accept();

  asio::io_context io{1};
  Tcp::acceptor acceptor{io};
  std::map<std::string, Document> page;
  std::string key;
  std::uint16_t port = 0;
  std::unique_ptr<OriginPolicy> rules;
  WebEvents events;
  Client last_client = 0;
  std::size_t guests = 0;
  std::map<Client, std::shared_ptr<WebSocketSession>> web_sockets;
  std::thread thread;
};

// A page with its WebSocket.
class WebSocketSession : public std::enable_shared_from_this<WebSocketSession> {
 public:
  WebSocketSession(Tcp::socket socket, HttpState& house, Client client)
      : socket_(std::move(socket)), state_(house), client_(client) {}

  void welcome(const http::request<http::string_body>& request) {
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestMax;
    timeout.idle_timeout = 2 * kPing;  // Beast pings at half of it
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(kMessageMax_bytes);
    socket_.next_layer().set_option(Tcp::no_delay(true));
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (error) return self->leave();
      self->state_.events.came(self->client_);
      self->read();
    });
  }

  void send(Outbox::Text text, Worth worth) {
    const bool idle = outbox_.empty();
    outbox_.put(std::move(text), worth);
    if (outbox_.overflows()) return cut();
    if (idle && !outbox_.empty()) write();
  }

  void cut() {
    Error ignored;
    socket_.next_layer().close(ignored);
  }

 private:
  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->leave();
      const std::string text = beast::buffers_to_string(self->buffer_.data());
      self->buffer_.consume(self->buffer_.size());
      if (!self->rate_.allows(now_us())) return self->leave();
      self->state_.events.said(self->client_, text);
      self->read();
    });
  }

  void write() {
    socket_.text(true);
    socket_.async_write(asio::buffer(outbox_.front()), [self = shared_from_this()](Error error, std::size_t) {
      if (error) return self->leave();
      self->outbox_.pop();
      if (!self->outbox_.empty()) self->write();
    });
  }

  void leave() {
    if (std::exchange(gone_, true)) return;
    cut();
    state_.web_sockets.erase(client_);
    state_.events.left(client_);
  }

  websocket::stream<Tcp::socket> socket_;
  HttpState& state_;
  Client client_;
  beast::flat_buffer buffer_;
  Outbox outbox_;
  RateLimit rate_;
  bool gone_ = false;
};

// One HTTP request, answered and closed, or made a WebSocketSession.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(Tcp::socket socket, HttpState& house) : stream_(std::move(socket)), state_(house) {
    ++state_.guests;
    parser_.header_limit(kHeaderMax_bytes);
    parser_.body_limit(0);
  }
  ~HttpSession() { --state_.guests; }

  void serve() {
    stream_.expires_after(kRequestMax);
    http::async_read(stream_, buffer_, parser_, [self = shared_from_this()](Error error, std::size_t) {
      if (!error) self->answer();
    });
  }

 private:
  void answer() {
    const auto& asked = parser_.get();
    const auto header = [&](http::field name) {
      const auto value = asked[name];
      return std::string_view(value.data(), value.size());
    };
    const std::string_view target(asked.target().data(), asked.target().size());
    const Request request{header(http::field::host), header(http::field::origin), target};
    if (!state_.rules->is_addressed_to_us(request)) return refuse(http::status::forbidden, "not this server");
    const std::string path(target.substr(0, target.find('?')));
    if (websocket::is_upgrade(asked)) return upgrade(request, path);
    if (asked.method() != http::verb::get) return refuse(http::status::method_not_allowed, "GET only");
    if (const auto file = state_.page.find(path); file != state_.page.end()) return send(file->second);
    if (!state_.rules->has_token(request)) return refuse(http::status::forbidden, "no token");
    if (const auto made = state_.events.document(path)) return send(*made);
    refuse(http::status::not_found, "no such page");
  }

  void upgrade(const Request& request, const std::string& path) {
    if (path != "/live" || !state_.rules->is_from_our_page(request) || !state_.rules->has_token(request))
      return refuse(http::status::forbidden, "not this page, or no token");
    if (state_.web_sockets.size() >= kClientsMax)
      return refuse(http::status::service_unavailable, "too many pages");
    stream_.expires_never();
    const Client client = ++state_.last_client;
    const auto visitor = std::make_shared<WebSocketSession>(stream_.release_socket(), state_, client);
    state_.web_sockets[client] = visitor;
    visitor->welcome(parser_.get());
  }

  void refuse(http::status status, const char* why) {
    status_ = status;
    send({"text/plain", std::make_shared<const std::string>(why)});
  }

  void send(const Document& document) {
    body_ = document.body;
    response_.emplace(std::piecewise_construct, std::make_tuple(body_->data(), body_->size()),
                      std::make_tuple(status_, 11u));
    auto& answer = *response_;
    answer.set(http::field::content_type, document.media_type);
    answer.set("Content-Security-Policy", document.self_contained ? kSelfContainedPolicy : kContentPolicy);
    answer.set("X-Content-Type-Options", "nosniff");
    answer.set("Referrer-Policy", "no-referrer");
    answer.set("Cross-Origin-Opener-Policy", "same-origin");
    answer.set("Cross-Origin-Resource-Policy", "same-origin");
    answer.set(http::field::cache_control, "no-store");
    answer.keep_alive(false);
    answer.prepare_payload();
    stream_.expires_after(kAnswerMax);
    http::async_write(stream_, answer, [self = shared_from_this()](Error, std::size_t) {
      Error ignored;
      self->stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  HttpState& state_;
  beast::flat_buffer buffer_;
  http::request_parser<http::string_body> parser_;
  http::status status_ = http::status::ok;
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
  rules = std::make_unique<OriginPolicy>(port, key);
}

void HttpState::accept() {
  acceptor.async_accept([this](Error error, Tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error && guests < kHttpSessionsMax) std::make_shared<HttpSession>(std::move(socket), *this)->serve();
    accept();
  });
}

HttpServer::HttpServer(const fs::path& page, std::uint16_t port, std::string token, WebEvents events)
    : state_(std::make_unique<HttpState>(page, std::move(token), std::move(events))) {
  state_->listen(port);
  state_->accept();
  state_->thread = std::thread([this] { state_->io.run(); });
}

HttpServer::~HttpServer() {
  state_->io.stop();
  state_->thread.join();
  for (const auto& [client, visitor] : std::exchange(state_->web_sockets, {})) visitor->cut();
}

std::string HttpServer::url() const {
  return fmt::format("http://127.0.0.1:{}/?t={}", state_->port, state_->key);
}

void HttpServer::send(Client client, Outbox::Text text, Worth worth) {
  asio::post(state_->io, [this, client, text = std::move(text), worth] {
    const auto found = state_->web_sockets.find(client);
    if (found != state_->web_sockets.end()) found->second->send(text, worth);
  });
}

void HttpServer::send_to_all(Outbox::Text text, Worth worth) {
  asio::post(state_->io, [this, text = std::move(text), worth] {
    for (const auto& [client, visitor] : std::map(state_->web_sockets)) visitor->send(text, worth);
  });
}

}  // namespace biopsy::console
