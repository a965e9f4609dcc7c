// The lines that are copper in a laboratory and, in simulation, a small file mapped by every process. One
// process makes it; the others take hold of it, each with leave to write its own block.
#pragma once

#include <filesystem>

#include "drivers/digital_io/io_block.hpp"

namespace biopsy::digital_io {

// Lays new lines, all dead, as `run_folder`/lines (mode 0600). An older file is replaced: who still holds it
// is cut off and feeds nobody. The folder should be in memory (tmpfs, as /run is): on a disk a write can wait
// for the disk. Throws ConfigError: cannot be made, or a running process still owns block of the older file.
void create_shared_io(const std::filesystem::path& run_folder);

enum class Owner { Nobody, Stage, Supervisor, Interlock, Panel };

class SharedIo {
 public:
  // Takes hold of the lines in `run_folder`; as an owner, of that owner's block alone, until the process
  // ends. Throws ConfigError: no such file, not ours or truncated, open to other users, another version, or
  // another process owns these block.
  SharedIo(const std::filesystem::path& run_folder, Owner owner);
  ~SharedIo();
  SharedIo(const SharedIo&) = delete;
  SharedIo& operator=(const SharedIo&) = delete;

  // A write to block of another owner is a bug; the page is read-only and the process ends by SIGSEGV.
  IoBlock& block() const { return *block_; }

 private:
  int file_ = -1;  // open as long as owned: the claim hangs on it
  IoBlock* block_ = nullptr;
};

}  // namespace biopsy::digital_io
