#include "drivers/digital_io/shared_io.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>

#include "robot/common/config_error.hpp"

namespace biopsy::digital_io {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMakeAnew = "stop the robot, then make the file anew with `biopsy up`";

class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  explicit operator bool() const { return descriptor_ >= 0; }
  int get() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }

 private:
  int descriptor_;
};

std::string reason(int error) {
  return std::generic_category().message(error);
}

// The first byte is locked by the owner; the kernel unlocks it however the process ends.
struct flock owners_lock() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_len = 1;
  return lock;
}

bool is_in_use(const fs::path& path) {
  const File file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct flock lock = owners_lock();
  return file && ::fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

void check(const File& file, const fs::path& path, Owner owner) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw ConfigError(reason(errno), path.string(), kMakeAnew);
  if (!S_ISREG(status.st_mode) || status.st_size != static_cast<off_t>(kFileSize))
    throw ConfigError("is not a file of digital I/O lines, or is truncated", path.string(), kMakeAnew);
  if ((status.st_mode & 037) != 0)
    throw ConfigError("is accessible to other users", path.string(),
                      "chmod 640, and find out who changed it");
  Header header;
  if (::pread(file.get(), &header, sizeof(Header), 0) != static_cast<ssize_t>(sizeof(Header)) ||
      header.magic != kMagic)
    throw ConfigError("is not a file of digital I/O lines", path.string(), kMakeAnew);
  if (header.version != kVersion)
    throw ConfigError("is of another version of this program", path.string(), kMakeAnew);
  if (header.owner != owner) throw ConfigError("is the file of another owner", path.string(), kMakeAnew);
}

void create(const fs::path& folder, Owner owner) {
  const fs::path path = folder / name_of(owner);
  static Header header;  // static: its padding is zero
  header.owner = owner;
  std::string temporary = (folder / ".lines-XXXXXX").string();
  const File file(::mkstemp(temporary.data()));  // mode 0600
  const auto give_up = [&](int error) {
    if (file) ::unlink(temporary.c_str());
    throw ConfigError("cannot be made: " + reason(error), path.string(),
                      "give a run folder that exists, can be written and has space");
  };
  if (!file) give_up(errno);
  // Allocated now: on a full disk a write to a mapped page would end the process.
  if (const int error = ::posix_fallocate(file.get(), 0, kFileSize); error != 0) give_up(error);
  if (::pwrite(file.get(), &header, sizeof header, 0) != static_cast<ssize_t>(sizeof header)) give_up(errno);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) give_up(errno);
}

}  // namespace

std::string_view name_of(Owner owner) {
  switch (owner) {
    case Owner::Stage:
      return "stage";
    case Owner::Supervisor:
      return "supervisor";
    case Owner::Interlock:
      return "interlock";
    case Owner::Panel:
      return "panel";
  }
  std::abort();
}

void create_shared_io(const fs::path& folder) {
  for (const Owner owner : kOwners)
    if (is_in_use(folder / name_of(owner)))
      throw ConfigError("belongs to a robot that is running", (folder / name_of(owner)).string(),
                        "stop that one first, or use another run folder");
  for (const Owner owner : kOwners) create(folder, owner);
}

IoFile::IoFile(const fs::path& folder, Owner owner, Access access) {
  const fs::path path = folder / name_of(owner);
  const bool own = access == Access::Own;
  File file(::open(path.c_str(), (own ? O_RDWR : O_RDONLY) | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file)
    throw ConfigError("cannot be opened: " + reason(errno), path.string(),
                      "start the robot with `biopsy up`, which makes it");
  check(file, path, owner);
  struct flock lock = owners_lock();
  if (own && ::fcntl(file.get(), F_OFD_SETLK, &lock) != 0)
    throw ConfigError("another process owns this file", path.string(),
                      "each process of the robot runs once; stop the other one");
  memory_ = ::mmap(nullptr, kFileSize, own ? PROT_READ | PROT_WRITE : PROT_READ, MAP_SHARED | MAP_POPULATE,
                   file.get(), 0);
  if (memory_ == MAP_FAILED)
    throw ConfigError("cannot be mapped: " + reason(errno), path.string(), kMakeAnew);
  file_ = file.release();
}

IoFile::~IoFile() {
  ::munmap(memory_, kFileSize);
  ::close(file_);
}

}  // namespace biopsy::digital_io
