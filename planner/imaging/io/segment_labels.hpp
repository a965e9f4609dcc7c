// Labels of segments that may overlap: each set of segments that share a voxel is a label of its own, so that
// nothing need be guessed about which of them counts.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>

namespace biopsy::imaging {

class SegmentLabels {
 public:
  // `names`: of segments, by their labels from 1. `where`: file, for messages.
  SegmentLabels(std::map<int, std::string> names, std::string where);

  // The label of voxels in the segments of `label` and in `segment`, as one name: "liver + lesion". `label`
  // 0: in no segment yet. Throws ConfigError where there are more sets than a label map may have labels.
  int joined(int label, int segment);

  const std::map<int, std::string>& names() const { return names_; }

 private:
  std::map<int, std::string> names_;
  std::map<int, std::set<int>> members_;  // of labels that stand for several segments
  std::map<std::set<int>, int> labels_;   // the way back
  std::map<std::pair<int, int>, int> known_;
  std::string where_;
};

}  // namespace biopsy::imaging
