#include "robot/procedure/images/anatomical_orientation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace biopsy::robot {
namespace {

struct Share {
  char letter;
  double size;
};

std::vector<Share> shares(const Direction& lps) {
  constexpr std::array<std::array<char, 2>, 3> kLetters{{{'R', 'L'}, {'A', 'P'}, {'I', 'S'}}};
  std::vector<Share> out;
  out.reserve(3);
  for (int axis = 0; axis < 3; ++axis)
    out.push_back({kLetters[static_cast<std::size_t>(axis)][lps[axis] > 0 ? 1 : 0], std::abs(lps[axis])});
  std::stable_sort(out.begin(), out.end(), [](const Share& a, const Share& b) { return a.size > b.size; });
  return out;
}

}  // namespace

std::string anatomical_directions(const Direction& lps) {
  std::string out;
  const std::vector<Share> all = shares(lps);
  for (const Share& share : all)
    if (share.size >= 0.25 * all.front().size) out += share.letter;
  return out;
}

std::string side_shares(const Direction& lps) {
  std::string out;
  for (const Share& share : shares(lps))
    if (share.size >= 0.005)
      out += fmt::format("{}{} {:.2f}", out.empty() ? "" : ", ", share.letter, share.size);
  return out;
}

}  // namespace biopsy::robot
