#include "planner/imaging/io/segment_labels.hpp"

#include <fmt/format.h>

#include "planner/imaging/io/labels.hpp"
#include "robot/common/config_error.hpp"

namespace biopsy::imaging {

SegmentLabels::SegmentLabels(std::map<int, std::string> names, std::string where)
    : names_(std::move(names)), where_(std::move(where)) {
  for (const auto& [label, name] : names_) members_[label] = {label}, labels_[{label}] = label;
}

int SegmentLabels::joined(int label, int segment) {
  if (label == 0 || label == segment) return segment;
  const auto [place, is_new] = known_.try_emplace({label, segment}, 0);
  if (!is_new) return place->second;
  std::set<int> members = members_.at(label);
  members.insert(segment);
  const auto found = labels_.find(members);
  if (found != labels_.end()) return place->second = found->second;
  if (names_.size() >= kLabelsMax)
    throw ConfigError(fmt::format("segments overlap in more than {} ways", kLabelsMax), where_,
                      "keep the segments that the needle can meet");
  const int next = names_.rbegin()->first + 1;
  std::string name;
  for (const int member : members) name += (name.empty() ? "" : " + ") + names_.at(member);
  names_[next] = std::move(name);
  labels_[members] = next;
  members_[next] = std::move(members);
  return place->second = next;
}

}  // namespace biopsy::imaging
