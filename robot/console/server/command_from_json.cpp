#include "robot/console/server/command_from_json.hpp"

#include <utility>

namespace biopsy::console {
namespace {

template <class Message>
bool read_as(const nlohmann::json& from, const std::string& type, commands::Any& to) {
  if (type != Message::kType) return false;
  FieldReader fields(from);
  Message message;
  read_fields(fields, message);
  fields.expect_no_more();
  to = std::move(message);
  return true;
}

template <std::size_t... N>
bool read_any(const nlohmann::json& from, const std::string& type, commands::Any& to,
              std::index_sequence<N...>) {
  return (read_as<std::variant_alternative_t<N, commands::Any>>(from, type, to) || ...);
}

}  // namespace

commands::Any command_from_json(const std::string& text) {
  const nlohmann::json from = nlohmann::json::parse(text, nullptr, false);
  if (!from.is_object() || !from.contains("type") || !from["type"].is_string())
    throw MessageFault("not a message with a type");
  commands::Any to;
  const auto type = from["type"].get<std::string>();
  if (!read_any(from, type, to, std::make_index_sequence<std::variant_size_v<commands::Any>>()))
    throw MessageFault("no such type");
  return to;
}

}  // namespace biopsy::console
