// How often each claim was checked and broken, and by what first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "tests/verification/model_checking/supervisor/invariants.hpp"

namespace biopsy::model_checking {

// What the graph as a whole, or two steps together, must fulfil; rows behind those of kInvariantTable.
enum class GraphClaim : std::uint8_t {
  WorseNeverPermitsMore,
  ForgottenDecidesNothing,
  TimeBetweenIsAlike,
  EveryModeReached,
  SafeReachable
};
inline constexpr std::size_t kGraphClaims = 5;
inline constexpr std::size_t kClaims = kInvariants + kGraphClaims;
constexpr std::size_t number_of(GraphClaim claim) {
  return kInvariants + static_cast<std::size_t>(claim);
}
std::string_view name_of_claim(std::size_t claim);
std::string_view sentence_of_claim(std::size_t claim);

// Where a claim was first broken: a reachable state, an input there, and the worse input or the equivalent
// beside it.
struct Counterexample {
  std::uint32_t state = 0;
  std::uint32_t input = 0;
  std::optional<std::uint32_t> worse;
};

struct ClaimTally {
  std::uint64_t checked = 0, broken = 0;
  std::optional<Counterexample> first;
};

// Of a run of steps. Runs that were taken side by side are added in their order.
struct Tallies {
  std::array<ClaimTally, kClaims> claims;

  void break_claim(std::size_t claim, const Counterexample& where) {
    if (claims[claim].broken++ == 0) claims[claim].first = where;
  }
  void break_claim(GraphClaim claim, const Counterexample& where) { break_claim(number_of(claim), where); }

  void add(const Tallies& later) {
    for (std::size_t c = 0; c < kClaims; ++c) {
      claims[c].checked += later.claims[c].checked;
      claims[c].broken += later.claims[c].broken;
      if (!claims[c].first) claims[c].first = later.claims[c].first;
    }
  }

  // Bit i of `excused`: claim i does not count.
  std::uint64_t broken(std::uint64_t excused = 0) const {
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < kClaims; ++c)
      if (((excused >> c) & 1U) == 0) sum += claims[c].broken;
    return sum;
  }
};
static_assert(kClaims <= 64);

}  // namespace biopsy::model_checking
