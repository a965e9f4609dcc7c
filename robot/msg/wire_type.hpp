// How a message goes over the wire. The specialisations are generated from bus.idl: robot/msg/wire_types.hpp.
#pragma once

#include <cstddef>

namespace biopsy {

// `Type` is the C struct that idlc makes, `descriptor()` what Cyclone DDS needs to know of it, `fields` a
// tuple of FieldPair: one for each field of the message.
template <class Message>
struct WireType;

template <class Value, class Wire>
struct FieldPair {
  Value value;            // member of the message
  Wire wire;              // member of the C struct
  std::size_t bound = 0;  // most octets of a sequence
};
template <class Value, class Wire>
FieldPair(Value, Wire, std::size_t = 0) -> FieldPair<Value, Wire>;

}  // namespace biopsy
