// Every message of the bus: any values go over the wire and come back, field by field.
#include "robot/transport/codec.hpp"

#include "robot/msg/topics.hpp"
#include "tests/verification/fuzz/any_message.hpp"
#include "tests/verification/properties/property.hpp"

namespace biopsy::properties {
namespace {

// How many members an aggregate has: as many as it can be initialised with.
struct Anything {
  template <class Value>
  operator Value() const;  // NOLINT(google-explicit-constructor)
};
template <class Aggregate, class... Values>
consteval std::size_t member_count() {
  if constexpr (requires { Aggregate{Values{}..., Anything{}}; })
    return member_count<Aggregate, Values..., Anything>();
  else
    return sizeof...(Values);
}

RC_GTEST_PROP(Codec, BringsBackEveryFieldOfEveryMessage, ()) {
  fuzz::for_each_message([]<class Message>() {
    static_assert(std::tuple_size_v<decltype(WireType<Message>::fields)> == member_count<Message>(),
                  "every field goes over the wire");
    const auto bytes = any_bytes(600);
    fuzz::Feed feed(bytes);
    const auto sent = fuzz::any_message<Message>(feed);
    typename WireType<Message>::Type wire{};
    transport::encode(sent, wire);
    Message back;
    transport::decode(wire, back);
    RC_ASSERT(back == sent);
  });
}

}  // namespace
}  // namespace biopsy::properties
