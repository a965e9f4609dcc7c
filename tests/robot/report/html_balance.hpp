#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace biopsy::report {

// Empty where every tag is closed in order, otherwise what is wrong. The page writes void elements as <br />.
inline std::string imbalance(const std::string& html) {
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const std::size_t end = html.find('>', at);
    if (end == std::string::npos) return "a tag never ends";
    const std::string tag = html.substr(at + 1, end - at - 1);
    if (tag.starts_with('!') || tag.ends_with('/')) continue;
    const bool closing = tag.starts_with('/');
    const std::size_t start = closing ? 1 : 0;
    const std::string name = tag.substr(start, tag.find_first_of(" \n", start) - start);
    if (name.empty() || !std::isalpha(static_cast<unsigned char>(name[0]))) return "a stray < before " + tag;
    if (std::count(tag.begin(), tag.end(), '"') % 2) return "an open quote in <" + tag + ">";
    if (!closing) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return "</" + name + "> closes <" + (open.empty() ? "nothing" : open.back()) + ">";
    } else {
      open.pop_back();
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is never closed";
}

}  // namespace biopsy::report
