// Question and answer between supervisor and gate, shared by both sides: shows that the driver still
// computes, on the permit it was last given and on the code it really wrote. Guards against faults; it is not
// cryptography.
#pragma once

#include <cstdint>

#include "robot/msg/fixed_messages.hpp"

namespace biopsy::safety {

// Finaliser of MurmurHash3: every input bit reaches every output bit.
constexpr std::uint32_t mix(std::uint32_t x) {
  x = (x ^ (x >> 16)) * 0x85EB'CA6BU;
  x = (x ^ (x >> 13)) * 0xC2B2'AE35U;
  return x ^ (x >> 16);
}

// The question in permit `seq`: differs from tick to tick, so that an old answer is wrong.
constexpr std::uint32_t challenge_of(std::uint32_t session, std::uint32_t seq) {
  return mix(mix(session + 0x9E37'79B9U) ^ seq);
}

// f(challenge, DAC code, state, seq). The code is the signed command in mV, `state` the mode of the honoured
// permit.
constexpr std::uint32_t answer_to(std::uint32_t challenge, std::int32_t command_mV, Mode state,
                                  std::uint32_t seq) {
  const std::uint32_t code = mix(challenge ^ static_cast<std::uint32_t>(command_mV));
  return mix(code ^ (static_cast<std::uint32_t>(state) << 24U) ^ seq);
}

}  // namespace biopsy::safety
