// Any values for any message, field by field as the IDL declares them: a new message is covered by itself.
#pragma once

#include "robot/transport/codec.hpp"
#include "tests/verification/fuzz/target.hpp"

namespace biopsy::fuzz {

// Each fits what the wire can hold, `Wire` being the type there, and `bound` the most octets of a list.
template <class Wire, class Value>
void fill_field(Feed& feed, Value& value, std::size_t bound) {
  if constexpr (std::is_enum_v<Value>) {
    value = static_cast<Value>(feed.any<std::uint8_t>() % kCount<Value>);
  } else if constexpr (std::is_arithmetic_v<Value>) {
    value = feed.any<Value>();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    value.resize(feed.any<std::uint8_t>() % sizeof(Wire));
    for (char& letter : value) letter = static_cast<char>(1 + feed.any<std::uint8_t>() % 255);
  } else {
    if constexpr (requires { value.resize(1); })
      value.resize(feed.any<std::uint16_t>() % std::min<std::size_t>(bound + 1, 4'096));
    for (auto& element : value) feed.fill(element);
  }
}

template <class Message>
Message any_message(Feed& feed) {
  Message message;
  const auto fill = [&](const auto& pair) {
    using Wire = std::remove_cvref_t<decltype(typename WireType<Message>::Type{}.*pair.wire)>;
    fill_field<Wire>(feed, message.*pair.value, pair.bound);
  };
  std::apply([&](const auto&... pair) { (fill(pair), ...); }, WireType<Message>::fields);
  return message;
}

// DO.operator()<Message>() for every message of the bus.
template <class Function, std::size_t... Index>
void for_each_message(const Function& act, std::index_sequence<Index...>) {
  (act.template operator()<std::tuple_element_t<Index, Messages>>(), ...);
}
template <class Function>
void for_each_message(const Function& act) {
  for_each_message(act, std::make_index_sequence<std::tuple_size_v<Messages>>());
}

}  // namespace biopsy::fuzz
