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
constexpr const char* kLayAnew = "stop the robot, then lay the lines anew with `biopsy up`";

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

// One byte of the file stands for one owner. The kernel lets go of it when the process is gone, however it
// went.
struct flock claim_of(Owner owner) {
  struct flock claim {};
  claim.l_type = F_WRLCK;
  claim.l_whence = SEEK_SET;
  claim.l_start = static_cast<off_t>(owner);
  claim.l_len = owner == Owner::Nobody ? 0 : 1;  // 0: all of them
  return claim;
}

bool is_in_use(const fs::path& path) {
  const File file(::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  struct flock claim = claim_of(Owner::Nobody);
  return file && ::fcntl(file.get(), F_OFD_GETLK, &claim) == 0 && claim.l_type != F_UNLCK;
}

void check(const File& file, const fs::path& path) {
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw ConfigError(reason(errno), path.string(), kLayAnew);
  if (!S_ISREG(status.st_mode) || status.st_size != static_cast<off_t>(sizeof(IoBlock)))
    throw ConfigError("is not a file of electrical lines, or is cut short", path.string(), kLayAnew);
  if ((status.st_mode & 077) != 0)
    throw ConfigError("can be reached by other users", path.string(), "chmod 600, and ask who changed it");
  Title title;
  if (::pread(file.get(), &title, sizeof(Title), 0) != static_cast<ssize_t>(sizeof(Title)) ||
      title.magic != kMagic)
    throw ConfigError("is not a file of electrical lines", path.string(), kLayAnew);
  if (title.version != kVersion || title.size != sizeof(IoBlock))
    throw ConfigError("holds electrical lines of another version of this program", path.string(), kLayAnew);
}

void* block_of(IoBlock* block, Owner owner) {
  switch (owner) {
    case Owner::Nobody:
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
  static const Title title{.size =
                               sizeof(IoBlock)};  // static: no stray bytes of the stack between its members
  std::string temporary = (run_folder / ".lines-XXXXXX").string();
  const File file(::mkstemp(temporary.data()));  // mode 0600
  const auto give_up = [&](int error) {
    if (file) ::unlink(temporary.c_str());
    throw ConfigError("cannot be made: " + reason(error), path.string(),
                      "give a run folder that exists, can be written and has space");
  };
  if (!file) give_up(errno);
  // Reserved, not only promised: a full disk must not be noticed by a write to a mapped page.
  if (const int error = ::posix_fallocate(file.get(), 0, sizeof(IoBlock)); error != 0) give_up(error);
  if (::pwrite(file.get(), &title, sizeof title, 0) != static_cast<ssize_t>(sizeof title)) give_up(errno);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) give_up(errno);
}

SharedIo::SharedIo(const fs::path& run_folder, Owner owner) {
  const fs::path path = run_folder / kName;
  const int way = owner == Owner::Nobody ? O_RDONLY : O_RDWR;
  File file(::open(path.c_str(), way | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (!file)
    throw ConfigError("cannot be opened: " + reason(errno), path.string(),
                      "lay the lines first, with `biopsy up`");
  check(file, path);
  struct flock claim = claim_of(owner);
  if (owner != Owner::Nobody && ::fcntl(file.get(), F_OFD_SETLK, &claim) != 0)
    throw ConfigError("another process drives these lines", path.string(),
                      "each process of the robot runs once; stop the other one");
  void* memory = ::mmap(nullptr, sizeof(IoBlock), PROT_READ, MAP_SHARED | MAP_POPULATE, file.get(), 0);
  if (memory == MAP_FAILED) throw ConfigError("cannot be mapped: " + reason(errno), path.string(), kLayAnew);
  block_ = static_cast<IoBlock*>(memory);
  void* own = block_of(block_, owner);
  if (own != nullptr && ::mprotect(own, kPage, PROT_READ | PROT_WRITE) != 0) {
    const int error = errno;
    ::munmap(memory, sizeof(IoBlock));
    throw ConfigError("cannot be written: " + reason(error), path.string(), kLayAnew);
  }
  file_ = file.release();
}

SharedIo::~SharedIo() {
  ::munmap(block_, sizeof(IoBlock));
  ::close(file_);
}

}  // namespace biopsy::digital_io
