// A folder into which a scanner exports its series, one file after another.
#pragma once

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "robot/msg/volume.hpp"

namespace biopsy::imaging {

// A series that arrived whole.
struct IncomingSeries {
  std::vector<std::filesystem::path> files;
  SeriesIdentity identity;                                        // empty where the format has none
  std::string image_type;                                         // DICOM: "ORIGINAL\PRIMARY\M"
  std::optional<std::chrono::system_clock::time_point> acquired;  // its first slice, by the scanner's clock
  std::chrono::system_clock::time_point written;                  // last change of its newest file
  std::string problem;  // why it is no image: not whole, damaged, uneven; empty: it is one
  // Neither a volume nor a stated number of slices: only time tells that no more will come.
  bool may_go_on = false;
};

class WatchedFolder {
 public:
  // What lies in the folder now is not new. A series counts as complete once nothing in the folder has
  // changed for `quiet`, its slices are evenly spaced, and their number is the one that they state (Images in
  // Acquisition), where they state one. DICOM may be a few slices or several orientations (a slab, three
  // planes); such a series that states no number must have been quiet for four times as long. Throws
  // ConfigError where the folder does not exist or cannot be read.
  WatchedFolder(std::filesystem::path folder, std::chrono::milliseconds quiet);

  // The first series that came since then and was not returned before, once it is complete; after four times
  // `quiet` without a change also one that is not, with the problem. `now`: a clock that never goes back.
  // Every format of read_volume; a damaged or unreadable file holds back the series until it is replaced.
  std::optional<IncomingSeries> poll(std::chrono::steady_clock::time_point now);

 private:
  using Stamp = std::pair<std::uintmax_t, std::filesystem::file_time_type>;  // size and last change
  using Listing = std::map<std::filesystem::path, Stamp>;

  Listing list() const;

  std::filesystem::path folder_;
  std::chrono::milliseconds quiet_;
  Listing past_, seen_;  // what was there at first or was returned; what the last poll saw
  std::optional<std::chrono::steady_clock::time_point> changed_;
};

// The voxels, as one volume and as read_stacks has them. Throw ConfigError as read_volume does.
Volume read_incoming(const IncomingSeries& series);
std::vector<Volume> read_incoming_stacks(const IncomingSeries& series);

}  // namespace biopsy::imaging
