// What a rehearsal simulates: the `[rehearsal]` table of a case.
#pragma once

#include <filesystem>
#include <optional>

#include "sim/scanner/susceptibility/needle_body.hpp"
#include "sim/scanner/susceptibility/sequence.hpp"

namespace biopsy {
class TomlTable;
}

namespace biopsy::robot {

// A single slice; and no longer than a locked needle may be held, with time to look at the image.
inline constexpr double kScanMin_s = 0.1, kScanMax_s = 120.0;

// Plant and tissue, and what the simulated scanner adds to the confirmation images.
struct Rehearsal {
  std::filesystem::path model, tissues;
  Seconds scan{30.0};  // that a confirmation image takes where the stage can lock the needle meanwhile
  double snr = 30.0;
  double motion_mm = 0.5;   // the patient shifts by up to this between images,
  double motion_deg = 0.5;  // and turns by up to this
  double coil_shading = 0.1;
  double ghost = 0.0;
  int ghost_shift_voxels = 0;
  std::optional<sim::NeedleBody> needle;  // with the field of its material; absent: a painted void that ends
                                          // at the tip. Entry and tip are filled in when an image is taken
  sim::Sequence sequence;
  bool accept_unseen = false;  // no image is rendered, each counts as accepted: a campaign without its time,
                               // in which no image catches a fault. Not of a case file
};

// Changes what the table has. Paths count from the folder of `file`. Throws ConfigError naming file and line.
void read_rehearsal(TomlTable table, const std::filesystem::path& file, Rehearsal& out);

}  // namespace biopsy::robot
