// Every field of a message, so that a claim covers those of tomorrow too.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>

#include "robot/msg/wire_types.hpp"

namespace biopsy::fields {

template <class Field>
void change(Field& field) {
  if constexpr (std::is_same_v<Field, bool>)
    field = !field;
  else if constexpr (std::is_enum_v<Field>)
    field = static_cast<Field>(static_cast<int>(field) == 1 ? 2 : 1);
  else if constexpr (std::is_arithmetic_v<Field>)
    field = static_cast<Field>(field + 1);
  else if constexpr (requires { field.push_back({}); })
    field.push_back({});
  else
    field[0] = static_cast<std::remove_reference_t<decltype(field[0])>>(field[0] + 1);
}

// Calls `each(member, changed)` for every field: the pointer to it, and `base` with this field changed alone.
template <class Message, class Each>
void for_each_field(const Message& base, const Each& each) {
  std::apply(
      [&](const auto&... pairs) {
        const auto one = [&](const auto member) {
          Message changed = base;
          change(changed.*member);
          each(member, changed);
        };
        (one(pairs.value), ...);
      },
      WireType<Message>::fields);
}

// A message whose numbers are all different, and its flags true.
template <class Message>
Message distinct(int first) {
  Message message{};
  std::apply(
      [&](const auto&... pairs) {
        const auto fill = [&](auto& field) {
          using Field = std::remove_reference_t<decltype(field)>;
          if constexpr (std::is_same_v<Field, bool>)
            field = true;
          else if constexpr (std::is_enum_v<Field>)
            field = static_cast<Field>(1);
          else if constexpr (std::is_arithmetic_v<Field>)
            field = static_cast<Field>(first++);
        };
        (fill(message.*(pairs.value)), ...);
      },
      WireType<Message>::fields);
  return message;
}

template <class A, class B>
constexpr bool same_member(A a, B b) {
  if constexpr (std::is_same_v<A, B>)
    return a == b;
  else
    return false;
}

}  // namespace biopsy::fields
