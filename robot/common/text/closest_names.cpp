#include "robot/common/text/closest_names.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace biopsy {
namespace {

constexpr std::size_t kMostNames = 3, kMostWithTheWord = 6;

std::string_view without_dashes(std::string_view name) {
  return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

}  // namespace

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      const std::size_t changed = d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, changed});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

std::vector<std::string> closest_names(const std::string& typed, const std::vector<std::string>& known) {
  const std::string_view word = without_dashes(typed);
  std::vector<std::pair<std::size_t, std::string>> close;
  std::size_t with_the_word = 0;
  for (const std::string& full_name : known) {
    const std::string_view name = without_dashes(full_name);
    const std::size_t distance = edit_distance(word, name);
    const bool is_part = word.size() >= 3 && name.find(word) != std::string_view::npos;
    with_the_word += is_part ? 1 : 0;
    if (is_part || (distance <= std::max<std::size_t>(2, name.size() / 4) && distance < name.size()))
      close.emplace_back(distance, full_name);
  }
  std::stable_sort(close.begin(), close.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  close.resize(std::min({close.size(), std::max(kMostNames, with_the_word), kMostWithTheWord}));
  std::vector<std::string> names;
  for (auto& [distance, name] : close) names.push_back(std::move(name));
  return names;
}

}  // namespace biopsy
