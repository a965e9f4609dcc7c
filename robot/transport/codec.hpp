// Between a message and what goes over the wire, field by field as bus.idl declares them. Decoding is total:
// a code that this build does not know becomes the value that allows least (@default_literal in bus.idl).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "robot/msg/wire_types.hpp"

namespace biopsy::transport {

namespace field {

template <class Value>
requires std::is_arithmetic_v<Value>
void encode(Value from, Value& to, std::size_t) {
  to = from;
}
template <class Enum>
requires std::is_enum_v<Enum>
void encode(Enum from, std::uint8_t& to, std::size_t) {
  to = static_cast<std::uint8_t>(from);
}
template <class Value, std::size_t Count>
void encode(const std::array<Value, Count>& from, Value (&to)[Count], std::size_t) {
  std::ranges::copy(from, to);
}
template <std::size_t Size>
void encode(const std::string& from, char (&to)[Size], std::size_t) {
  const std::size_t length = std::min(from.size(), Size - 1);
  std::copy_n(from.begin(), length, to);
  to[length] = '\0';
}
// `to` borrows the bytes of `from`.
template <class Sequence>
void encode(const std::vector<std::uint8_t>& from, Sequence& to, std::size_t bound) {
  to._maximum = to._length = static_cast<std::uint32_t>(std::min(from.size(), bound));
  to._buffer = const_cast<std::uint8_t*>(from.data());  // read only: the C type cannot express it
  to._release = false;
}

template <class Value>
requires std::is_arithmetic_v<Value>
void decode(Value from, Value& to) {
  to = from;
}
template <class Enum>
requires std::is_enum_v<Enum>
void decode(std::uint8_t from, Enum& to) {
  to = from_code<Enum>(from);
}
template <class Value, std::size_t Count>
void decode(const Value (&from)[Count], std::array<Value, Count>& to) {
  std::ranges::copy(from, to.begin());
}
template <std::size_t Size>
void decode(const char (&from)[Size], std::string& to) {
  to.assign(from, std::find(from, from + Size, '\0'));
}
template <class Sequence>
void decode(const Sequence& from, std::vector<std::uint8_t>& to) {
  to.assign(from._buffer, from._buffer + from._length);
}

}  // namespace field

// Lists in `to` borrow their bytes from `from`.
template <class Message>
void encode(const Message& from, typename WireType<Message>::Type& to) {
  std::apply([&](auto... pair) { (field::encode(from.*pair.value, to.*pair.wire, pair.bound), ...); },
             WireType<Message>::fields);
}

template <class Message>
void decode(const typename WireType<Message>::Type& from, Message& to) {
  std::apply([&](auto... pair) { (field::decode(from.*pair.wire, to.*pair.value), ...); },
             WireType<Message>::fields);
}

}  // namespace biopsy::transport
