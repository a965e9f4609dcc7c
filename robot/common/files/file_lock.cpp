#include "robot/common/files/file_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "robot/common/config_error.hpp"

namespace biopsy {

// flock, not fcntl: SQLite's own locks on the file are of the other kind, and neither disturbs the other.
FileLock::FileLock(const std::filesystem::path& log) : file_(::open(log.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (file_ < 0)
    throw ConfigError(std::string("the log cannot be opened: ") + std::strerror(errno), log.string(),
                      "choose a log that this user may read and write");
  if (::flock(file_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(file_);
  throw ConfigError("another recorder is writing this log", log.string(), "stop it, or choose another log");
}

FileLock::~FileLock() {
  ::close(file_);
}

}  // namespace biopsy
