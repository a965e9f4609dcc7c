// A topic of the bus: how its samples are delivered, who may write them, how they are protected. The topics
// themselves are declared in bus.idl and generated: robot/msg/topics.hpp.
#pragma once

#include <chrono>
#include <cstdint>
#include <string_view>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy {

// A set of roles.
class Writers {
 public:
  template <class... Some>
  explicit constexpr Writers(Some... some) : bits_((0U | ... | bit(some))) {}
  constexpr bool contains(security::Role role) const { return (bits_ & bit(role)) != 0; }

 private:
  static constexpr unsigned bit(security::Role role) { return 1U << static_cast<unsigned>(role); }
  unsigned bits_;
};

enum class Protection : std::uint8_t {
  Signed,     // no one without keys can alter a sample
  Encrypted,  // nor read it
};

struct Topic {
  std::string_view name;
  bool reliable = false;
  bool transient_local = false;           // a late joiner gets the last sample
  std::int32_t depth = 1;                 // samples that a reader keeps
  std::chrono::milliseconds lease{0};     // of liveliness (manual by topic); 0: a writer may be silent
  std::chrono::milliseconds deadline{0};  // longest time between two samples; 0: none
  Writers writers{};
  Protection protection = Protection::Encrypted;
};

template <class Message>
inline constexpr Topic kTopic{};

}  // namespace biopsy
