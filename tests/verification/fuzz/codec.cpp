// Whatever stands on the wire, decoding is total: only codes this build knows come out, and what comes out
// goes over the wire and back unchanged.
#include "robot/transport/codec.hpp"

#include <cstring>

#include "robot/msg/topics.hpp"
#include "tests/verification/fuzz/any_message.hpp"

namespace {

using namespace biopsy;
using namespace biopsy::fuzz;

// The library's reader lets no boolean through that is neither, and ends every text.
template <class Wire>
void make_sound(Wire& field, Bytes bytes) {
  if constexpr (std::is_same_v<Wire, bool>) {
    *reinterpret_cast<unsigned char*>(&field) &= 1U;
  } else if constexpr (std::is_array_v<Wire> && std::is_same_v<std::remove_extent_t<Wire>, char>) {
    field[std::extent_v<Wire> - 1] = '\0';
  } else if constexpr (requires { field._buffer; }) {
    field._maximum = field._length = static_cast<std::uint32_t>(bytes.size());
    field._buffer = const_cast<std::uint8_t*>(bytes.data());
    field._release = false;
  }
}

template <class Value, class Wire>
void claim_field_sound(const Value& value, const Wire& wire) {
  if constexpr (std::is_enum_v<Value>)
    claim(static_cast<std::size_t>(value) < kCount<Value>, "a code that exists");
  if constexpr (std::is_same_v<Value, std::string>)
    claim(value.size() < sizeof(wire), "a text no longer than the wire's");
}

template <class Message>
void there_and_back(Bytes bytes) {
  typename WireType<Message>::Type wire, again;
  std::memset(&wire, 0, sizeof(wire));
  std::memset(&again, 0, sizeof(again));
  std::memcpy(&wire, bytes.data(), std::min(bytes.size(), sizeof(wire)));
  const auto on_each_field = [](const auto& act) {
    std::apply([&](auto... pair) { (act(pair), ...); }, WireType<Message>::fields);
  };
  on_each_field([&](auto pair) { make_sound(wire.*pair.wire, bytes); });
  Message first, second;
  transport::decode(wire, first);
  on_each_field([&](auto pair) { claim_field_sound(first.*pair.value, wire.*pair.wire); });
  transport::encode(first, again);
  transport::decode(again, second);
  claim(first == second, "there and back is the same");
}

}  // namespace

FUZZ(codec) {
  if (bytes.empty()) return;
  std::size_t index = 0;
  for_each_message([&]<class Message>() {
    if (index++ == bytes[0] % std::tuple_size_v<Messages>) there_and_back<Message>(bytes.subspan(1));
  });
}
