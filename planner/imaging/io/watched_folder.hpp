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
  bool plane = false;          // few slices of one orientation: others may belong to the same image
  int slices = 0, stated = 0;  // DICOM: their number, and the one that they state; 0: none
};

// One image: a series, or the planes of one that were exported as a series each.
using IncomingImage = std::vector<IncomingSeries>;

class WatchedFolder {
 public:
  // What lies in the folder now is not new. A series counts as complete once nothing in the folder has
  // changed for `quiet`, its slices are evenly spaced, and their number is the one that they state (Images in
  // Acquisition), where they state one. DICOM may be a few slices or several orientations (a slab, three
  // planes); such a series that states no number must have been quiet for four times as long. Series of few
  // slices in up to three orientations are the planes of one image: it is complete once there are `planes` of
  // them; 0, not known: three, or as many as there are after four times `quiet`. Throws ConfigError where the
  // folder does not exist or cannot be read.
  WatchedFolder(std::filesystem::path folder, std::chrono::milliseconds quiet, std::size_t planes = 0);

  // The first image that came since then and was not returned before, once it is complete; after four times
  // `quiet` without a change also one that is not, with the problem; empty: none. Planes that were not taken
  // together have that as their problem. `now`: a clock that never goes back. Every format of read_volume; a
  // damaged or unreadable file holds back the series until it is replaced.
  IncomingImage poll(std::chrono::steady_clock::time_point now);

  // What lies there, but is not complete, for a person: "1 of 3 planes"; empty: nothing new.
  std::string incomplete() const;

 private:
  using Stamp = std::pair<std::uintmax_t, std::filesystem::file_time_type>;  // size and last change
  using Listing = std::map<std::filesystem::path, Stamp>;

  Listing list() const;
  std::vector<IncomingImage> fresh() const;
  bool lacks_planes(const IncomingImage& image) const;
  void take(IncomingSeries& series);

  std::filesystem::path folder_;
  std::chrono::milliseconds quiet_;
  std::size_t planes_;
  Listing past_, seen_;  // what was there at first or was returned; what the last poll saw
  std::optional<std::chrono::steady_clock::time_point> changed_;
};

// The voxels, as one volume and as read_stacks has them. Throw ConfigError as read_volume does.
Volume read_incoming(const IncomingSeries& series);
std::vector<Volume> read_incoming_stacks(const IncomingImage& image);

}  // namespace biopsy::imaging
