// The digital I/O lines between processes, simulated by small files that every process maps, one for each
// owner. One process makes them; each of the others may write its own.
#pragma once

#include <array>
#include <filesystem>
#include <string_view>

#include "drivers/digital_io/io_layout.hpp"

namespace biopsy::digital_io {

inline constexpr std::array kOwners{Owner::Stage, Owner::Supervisor, Owner::Interlock, Owner::Panel};

// The name of the owner's file in `folder`: stage, supervisor, interlock, panel.
std::string_view name_of(Owner owner);

// Makes the files of all owners in `folder` (mode 0600), all zero. Older ones are replaced; processes that
// still map them no longer reach the others. The folder should be in memory (tmpfs): on a disk a write can
// wait for the disk. Throws ConfigError: cannot be made, or a running process still owns one of the older
// files.
void create_shared_io(const std::filesystem::path& folder);

// One owner's file, mapped.
class IoFile {
 public:
  enum class Access { Read, Own };
  // Own: writable, and held until the process ends. Throws ConfigError: no such file, of another kind, owner
  // or version, truncated; another user may write it, or all may read it; another process owns it.
  IoFile(const std::filesystem::path& folder, Owner owner, Access access);
  ~IoFile();
  IoFile(const IoFile&) = delete;
  IoFile& operator=(const IoFile&) = delete;

  // The page of outputs. Where only read, a write to it ends the process by SIGSEGV.
  void* outputs() const { return static_cast<std::byte*>(memory_) + kPage; }

 private:
  int file_ = -1;  // open as long as mapped: it holds the owner's lock
  void* memory_ = nullptr;
};

// The outputs that this process writes.
template <class Outputs>
class OwnOutputs {
 public:
  explicit OwnOutputs(const std::filesystem::path& folder)
      : file_(folder, Outputs::kOwner, IoFile::Access::Own) {}
  Outputs* operator->() const { return static_cast<Outputs*>(file_.outputs()); }

 private:
  IoFile file_;
};

// Those of another owner.
template <class Outputs>
class SeenOutputs {
 public:
  explicit SeenOutputs(const std::filesystem::path& folder)
      : file_(folder, Outputs::kOwner, IoFile::Access::Read) {}
  const Outputs* operator->() const { return static_cast<const Outputs*>(file_.outputs()); }

 private:
  IoFile file_;
};

}  // namespace biopsy::digital_io
