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

constexpr const char* kName = "lines";
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

// One byte of the file is locked for each owner; the kernel unlocks it however the process ends.
struct flock lock_of(Owner owner) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(owner);
  lock.l_len = owner == Owner::None ? 0 : 1;  // 0: all of them
  return lock;
}

bool is_in_use(const fs::path& path) {
  const File file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct flock lock = lock_of(Owner::None);
  return file && ::fcntl(file.get(), F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

void check(const File& file, const fs::path& path) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw ConfigError(reason(errno), path.string(), kMakeAnew);
  if (!S_ISREG(status.st_mode) || status.st_size != static_cast<off_t>(sizeof(IoBlock)))
    throw ConfigError("is not a file of digital I/O lines, or is truncated", path.string(), kMakeAnew);
  if ((status.st_mode & 077) != 0)
    throw ConfigError("is accessible to other users", path.string(),
                      "chmod 600, and find out who changed it");
  Header header;
  if (::pread(file.get(), &header, sizeof(Header), 0) != static_cast<ssize_t>(sizeof(Header)) ||
      header.magic != kMagic)
    throw ConfigError("is not a file of digital I/O lines", path.string(), kMakeAnew);
  if (header.version != kVersion || header.size != sizeof(IoBlock))
    throw ConfigError("is of another version of this program", path.string(), kMakeAnew);
}

void* block_of(IoBlock* block, Owner owner) {
  switch (owner) {
    case Owner::None:
      return nullptr;
    case Owner::Stage:
      return &block->stage;
    case Owner::Supervisor:
      return &block->supervisor;
    case Owner::Interlock:
      return &block->interlock;
    case Owner::Panel:
      return &block->panel;
  }
  std::abort();
}

}  // namespace

void create_shared_io(const fs::path& run_folder) {
  const fs::path path = run_folder / kName;
  if (is_in_use(path))
    throw ConfigError("belongs to a robot that is running", path.string(),
                      "stop that one first, or use another run folder");
  static const Header header{.size = sizeof(IoBlock)};  // static: its padding is zero
  std::string temporary = (run_folder / ".lines-XXXXXX").string();
  const File file(::mkstemp(temporary.data()));  // mode 0600
  const auto give_up = [&](int error) {
    if (file) ::unlink(temporary.c_str());
    throw ConfigError("cannot be made: " + reason(error), path.string(),
                      "give a run folder that exists, can be written and has space");
  };
  if (!file) give_up(errno);
  // Allocated now: on a full disk a write to a mapped page would end the process.
  if (const int error = ::posix_fallocate(file.get(), 0, sizeof(IoBlock)); error != 0) give_up(error);
  if (::pwrite(file.get(), &header, sizeof header, 0) != static_cast<ssize_t>(sizeof header)) give_up(errno);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) give_up(errno);
}

SharedIo::SharedIo(const fs::path& run_folder, Owner owner) {
  const fs::path path = run_folder / kName;
  const int way = owner == Owner::None ? O_RDONLY : O_RDWR;
  File file(::open(path.c_str(), way | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file)
    throw ConfigError("cannot be opened: " + reason(errno), path.string(),
                      "start the robot with `biopsy up`, which makes it");
  check(file, path);
  struct flock lock = lock_of(owner);
  if (owner != Owner::None && ::fcntl(file.get(), F_OFD_SETLK, &lock) != 0)
    throw ConfigError("another process owns this block", path.string(),
                      "each process of the robot runs once; stop the other one");
  void* memory = ::mmap(nullptr, sizeof(IoBlock), PROT_READ, MAP_SHARED | MAP_POPULATE, file.get(), 0);
  if (memory == MAP_FAILED) throw ConfigError("cannot be mapped: " + reason(errno), path.string(), kMakeAnew);
  block_ = static_cast<IoBlock*>(memory);
  void* own = block_of(block_, owner);
  if (own != nullptr && ::mprotect(own, kPage, PROT_READ | PROT_WRITE) != 0) {
    const int error = errno;
    ::munmap(memory, sizeof(IoBlock));
    throw ConfigError("cannot be written: " + reason(error), path.string(), kMakeAnew);
  }
  file_ = file.release();
}

SharedIo::~SharedIo() {
  ::munmap(block_, sizeof(IoBlock));
  ::close(file_);
}

}  // namespace biopsy::digital_io
