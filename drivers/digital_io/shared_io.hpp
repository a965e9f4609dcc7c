// The digital I/O lines between processes, simulated by a small file that every process maps. One process
// makes it; each of the others may write its own block.
#pragma once

#include <filesystem>

#include "drivers/digital_io/io_block.hpp"

namespace biopsy::digital_io {

// Makes the file `run_folder`/lines (mode 0600), all zero. An older file is replaced; processes that still
// map it no longer reach the others. The folder should be in memory (tmpfs): on a disk a write can wait for
// the disk. Throws ConfigError: cannot be made, or a running process still owns a block of the older file.
void create_shared_io(const std::filesystem::path& run_folder);

enum class Owner { None, Stage, Supervisor, Interlock, Panel };

class SharedIo {
 public:
  // Maps the file in `run_folder`; an owner holds its block until the process ends. Throws ConfigError: no
  // such file, of another kind or truncated, accessible to other users, another version, or another process
  // owns this block.
  SharedIo(const std::filesystem::path& run_folder, Owner owner);
  ~SharedIo();
  SharedIo(const SharedIo&) = delete;
  SharedIo& operator=(const SharedIo&) = delete;

  // Another owner's block is read-only: a write to it ends the process by SIGSEGV.
  IoBlock& block() const { return *block_; }

 private:
  int file_ = -1;  // open as long as owned: it holds the lock
  IoBlock* block_ = nullptr;
};

}  // namespace biopsy::digital_io
