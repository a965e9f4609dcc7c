#include "robot/console/server/origin_policy.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "robot/common/config_error.hpp"

namespace biopsy::console {
namespace {

constexpr std::array<std::string_view, 2> kNames{"127.0.0.1", "localhost"};
constexpr std::size_t kTokenDigits = 32;

// Takes as long for every wrong token.
bool equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned char>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

bool OriginPolicy::is_addressed_to_us(const Request& request) const {
  const bool host = std::any_of(kNames.begin(), kNames.end(), [&](std::string_view name) {
    return request.host == fmt::format("{}:{}", name, port_);
  });
  return host && (request.origin.empty() || is_from_our_page(request));
}

bool OriginPolicy::is_from_our_page(const Request& request) const {
  return request.origin == fmt::format("http://{}", request.host) &&
         request.host.ends_with(fmt::format(":{}", port_));
}

bool OriginPolicy::has_token(const Request& request) const {
  constexpr std::string_view kKey = "?t=";
  const std::size_t query = request.target.find(kKey);
  return query != std::string_view::npos && equal(request.target.substr(query + kKey.size()), token_);
}

std::string new_token() {
  std::array<unsigned char, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    throw ConfigError("no randomness", "getrandom", "check the system");
  std::string token;
  for (const unsigned char byte : random) token += fmt::format("{:02x}", byte);
  return token;
}

std::optional<Address> address_of(std::string_view url) {
  constexpr std::string_view kStart = "http://127.0.0.1:", kKey = "/?t=";
  if (!url.starts_with(kStart)) return std::nullopt;
  url.remove_prefix(kStart.size());
  Address address;
  const auto [end, error] = std::from_chars(url.data(), url.data() + url.size(), address.port);
  if (error != std::errc()) return std::nullopt;
  url.remove_prefix(static_cast<std::size_t>(end - url.data()));
  if (!url.starts_with(kKey)) return std::nullopt;
  address.token = url.substr(kKey.size(), kTokenDigits);
  const bool digits = std::all_of(address.token.begin(), address.token.end(),
                                  [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
  if (!digits || address.token.size() != kTokenDigits) return std::nullopt;
  return address;
}

bool RateLimit::allows(std::int64_t now_us) {
  const double passed_s = static_cast<double>(now_us - last_us_) * 1e-6;
  left_ = std::min(kBurst, left_ + (last_us_ == 0 ? 0.0 : passed_s * kPerSecond));
  last_us_ = now_us;
  if (left_ < 1.0) return false;
  left_ -= 1.0;
  return true;
}

}  // namespace biopsy::console
