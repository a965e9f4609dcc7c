#include "tests/verification/model_checking/sweep/tallies.hpp"

namespace biopsy::model_checking {

std::string_view name_of_claim(std::size_t claim) {
  constexpr std::array<std::string_view, kGraphClaims> kNames{
      "worse-never-permits-more", "forgotten-decides-nothing", "time-between-is-alike", "every-mode-reached",
      "safe-reachable"};
  return claim < kInvariants ? kInvariantTable[claim].name : kNames.at(claim - kInvariants);
}

std::string_view sentence_of_claim(std::size_t claim) {
  constexpr std::array<std::string_view, kGraphClaims> kSentences{
      "An input that is worse in one respect never gives a more permissive output.",
      "What the exploration forgets decides nothing: an equivalent of each step does the same, also with arm "
      "and reset asked over the network.",
      "Between the first and the last ticks of a time every input does what it does in the first.",
      "Every mode is reached.",
      "From every state but Lock some healthy script reaches Safe (not from Boot in the tick its 10 s run "
      "out)."};
  return claim < kInvariants ? kInvariantTable[claim].sentence : kSentences.at(claim - kInvariants);
}

}  // namespace biopsy::model_checking
