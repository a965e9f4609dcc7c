// The lines that are copper in a laboratory and, in simulation, a small file mapped by every process. One
// process makes it; the others take hold of it, each with leave to write its own wires.
#pragma once

#include <filesystem>

#include "drivers/digital_io/io_block.hpp"

namespace biopsy::lines {

// Lays new lines, all dead, as `run_folder`/lines (mode 0600). An older file is replaced: who still holds it
// is cut off and feeds nobody. The folder should be in memory (tmpfs, as /run is): on a disk a write can wait
// for the disk. Throws SetupError: cannot be made, or a running process still owns wires of the older file.
void lay_lines(const std::filesystem::path& run_folder);

enum class Owner { Nobody, Stage, Supervisor, Interlock, Panel };

class ElectricalLines {
 public:
  // Takes hold of the lines in `run_folder`; as an owner, of that owner's wires alone, until the process
  // ends. Throws SetupError: no such file, not ours or truncated, open to other users, another version, or
  // another process owns these wires.
  ElectricalLines(const std::filesystem::path& run_folder, Owner owner);
  ~ElectricalLines();
  ElectricalLines(const ElectricalLines&) = delete;
  ElectricalLines& operator=(const ElectricalLines&) = delete;

  // A write to wires of another owner is a bug; the page is read-only and the process ends by SIGSEGV.
  Wires& wires() const { return *wires_; }

 private:
  int file_ = -1;  // open as long as owned: the claim hangs on it
  Wires* wires_ = nullptr;
};

}  // namespace biopsy::lines
