#include "planner/imaging/io/label_pattern.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace biopsy::imaging {
namespace {

constexpr std::size_t kValuesMin = 5;
constexpr double kAlikeMin = 0.6, kAloneMax = 0.1, kSingleMax = 0.25, kNextValueMax = 0.35;

// Values by their rank, so that labels 2 and 5 without any between follow each other.
std::vector<float> values_of(const Volume& volume) {
  std::vector<float> values;
  float last = -1.0F;
  for (const float value : volume.voxels) {
    if (value == last) continue;  // most are
    last = value;
    const auto at = std::lower_bound(values.begin(), values.end(), value);
    if (at == values.end() || *at != value) values.insert(at, value);
  }
  return values;
}

double share(std::size_t part, std::size_t of) {
  return of > 0 ? static_cast<double>(part) / static_cast<double>(of) : 0.0;
}

struct Counts {
  std::size_t pairs = 0, alike = 0, different = 0, next = 0;  // of neighbours in rows and columns
  std::size_t labelled = 0, alone = 0, pieces = 0;
};

// The pieces of one slice, joined over all eight neighbours.
class Pieces {
 public:
  explicit Pieces(std::size_t voxels) : parent_(voxels) { std::iota(parent_.begin(), parent_.end(), 0U); }

  void join(std::size_t a, std::size_t b) { parent_[root(a)] = root(b); }
  bool heads(std::size_t n) { return root(n) == n; }

 private:
  std::uint32_t root(std::size_t n) {
    auto at = static_cast<std::uint32_t>(n);
    while (parent_[at] != at) at = parent_[at] = parent_[parent_[at]];
    return at;
  }

  std::vector<std::uint32_t> parent_;
};

void count_slice(const Volume& volume, int k, const std::vector<float>& values, Counts& counts) {
  const int width = volume.grid.size.x(), height = volume.grid.size.y();
  const auto place = [&](int i, int j) {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(width) * static_cast<std::size_t>(j);
  };
  Pieces pieces(place(0, height));
  std::vector<bool> alone(place(0, height), true);
  constexpr std::array<std::array<int, 2>, 4> kBefore{{{-1, 0}, {0, -1}, {-1, -1}, {1, -1}}};
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      for (std::size_t n = 0; n < kBefore.size(); ++n) {
        const int bi = i + kBefore[n][0], bj = j + kBefore[n][1];
        if (bi < 0 || bi >= width || bj < 0) continue;
        const float here = volume.at(i, j, k), before = volume.at(bi, bj, k);
        if (here == 0.0F && before == 0.0F) continue;
        const bool same = here == before, in_line = n < 2;
        counts.pairs += in_line, counts.alike += in_line && same, counts.different += in_line && !same;
        if (same) {
          pieces.join(place(i, j), place(bi, bj));
          alone[place(i, j)] = alone[place(bi, bj)] = false;
        } else if (in_line) {
          const auto low = std::lower_bound(values.begin(), values.end(), std::min(here, before));
          counts.next += low + 1 != values.end() && *(low + 1) == std::max(here, before);
        }
      }
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (volume.at(i, j, k) == 0.0F) continue;
      ++counts.labelled;
      counts.alone += alone[place(i, j)];
      counts.pieces += pieces.heads(place(i, j));
    }
}

}  // namespace

LabelPattern label_pattern(const Volume& volume) {
  const std::vector<float> values = values_of(volume);
  Counts counts;
  for (int k = 0; k < volume.grid.size.z(); ++k) count_slice(volume, k, values, counts);
  LabelPattern pattern;
  pattern.values = values.size();
  if (counts.pairs > 0) pattern.alike = share(counts.alike, counts.pairs);
  pattern.alone = share(counts.alone, counts.labelled);
  pattern.single = share(counts.alone, counts.pieces);
  pattern.next_value = share(counts.next, counts.different);
  return pattern;
}

std::string grey_pattern(const LabelPattern& p) {
  if (p.alone > kAloneMax)
    return fmt::format("{:.0f} % of the voxels equal none of their neighbours", 100.0 * p.alone);
  const bool speckled = p.single > kSingleMax;
  if (p.values < kValuesMin && !speckled) return {};
  if (p.alike < kAlikeMin) return fmt::format("only {:.0f} % of the neighbours are alike", 100.0 * p.alike);
  if (p.values >= kValuesMin && speckled && p.next_value > kNextValueMax)
    return fmt::format(
        "{:.0f} % of its pieces are single voxels, and {:.0f} % of the edges lead to the next value",
        100.0 * p.single, 100.0 * p.next_value);
  return {};
}

}  // namespace biopsy::imaging
