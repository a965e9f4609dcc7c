#include "tests/robot/live/processes/fake_system.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace biopsy::fake_system {
namespace {

constexpr pid_t kFirst = 5'000'000;  // beyond those of the kernel

FakeSystem* one = nullptr;

// The C library's own.
template <class Function>
Function* real(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

std::string name_of_signal(int signal) {
  return signal == SIGCONT ? "CONT" : signal == SIGTERM ? "TERM" : signal == SIGKILL ? "KILL" : "?";
}

int send(FakeSystem& system, pid_t pid, int signal) {
  system.signals.push_back(name_of_signal(signal) + " " + std::to_string(pid));
  const auto found = system.children.find(pid);
  if (found == system.children.end()) return errno = ESRCH, -1;
  Child& child = found->second;
  const int ends_with = signal == SIGTERM ? child.on_term : signal == SIGKILL ? child.on_kill : kNever;
  if (ends_with == kNever || child.ends_at.count() >= 0) return 0;
  child.ends_at = system.now + child.takes;
  child.ends_with = ends_with;
  return 0;
}

pid_t collect(FakeSystem& system, pid_t pid, int* status) {
  const auto found = system.children.find(pid);
  if (found == system.children.end()) return errno = ECHILD, -1;
  Child& child = found->second;
  if (!child.status && child.ends_at.count() >= 0 && system.now >= child.ends_at)
    child.status = child.ends_with;
  if (!child.status) return 0;
  *status = *child.status;
  system.children.erase(found);
  return pid;
}

}  // namespace

FakeSystem::FakeSystem(std::filesystem::path file) : program(std::move(file)) {
  one = this;
}

FakeSystem::~FakeSystem() {
  one = nullptr;
}

FakeSystem* present() {
  return one;
}

}  // namespace biopsy::fake_system

using biopsy::fake_system::present;
using biopsy::fake_system::real;

extern "C" {

pid_t fork() noexcept {
  auto* const system = present();
  if (system == nullptr) return real<pid_t()>("fork")();
  if (system->starts_real_processes) {
    const pid_t pid = real<pid_t()>("fork")();
    if (pid > 0) system->started.push_back(pid);
    return pid;
  }
  if (system->no_more_processes) return errno = EAGAIN, -1;
  const auto pid = biopsy::fake_system::kFirst + static_cast<pid_t>(system->started.size());
  system->started.push_back(pid);
  system->children[pid] = {};
  return pid;
}

pid_t waitpid(pid_t pid, int* status, int options) {
  auto* const system = present();
  if (system == nullptr || system->starts_real_processes)
    return real<pid_t(pid_t, int*, int)>("waitpid")(pid, status, options);
  return biopsy::fake_system::collect(*system, pid, status);
}

// A mutant's -1 would reach every process of the machine: none but those that the test started gets a signal.
int kill(pid_t pid, int signal) noexcept {
  auto* const system = present();
  if (system == nullptr) std::abort();
  if (!system->starts_real_processes) return biopsy::fake_system::send(*system, pid, signal);
  const bool is_own = std::find(system->started.begin(), system->started.end(), pid) != system->started.end();
  if (!is_own) std::abort();
  return real<int(pid_t, int)>("kill")(pid, signal);
}

int nanosleep(const timespec* time, timespec* left) {
  auto* const system = present();
  if (system == nullptr || system->starts_real_processes)
    return real<int(const timespec*, timespec*)>("nanosleep")(time, left);
  system->now += std::chrono::seconds(time->tv_sec) + std::chrono::nanoseconds(time->tv_nsec);
  if (system->on_sleep) system->on_sleep();
  return 0;
}

int prctl(int option, ...) noexcept {
  std::va_list words;
  va_start(words, option);
  unsigned long given[4];
  for (unsigned long& word : given) word = va_arg(words, unsigned long);
  va_end(words);
  if (auto* const system = present(); system != nullptr && system->on_prctl) system->on_prctl();
  return static_cast<int>(::syscall(SYS_prctl, option, given[0], given[1], given[2], given[3]));
}

pid_t getppid() noexcept {
  if (auto* const system = present(); system != nullptr && system->parent) return *system->parent;
  return real<pid_t()>("getppid")();
}

ssize_t readlink(const char* path, char* buffer, size_t size) noexcept {
  auto* const system = present();
  if (system == nullptr || std::strcmp(path, "/proc/self/exe") != 0)
    return real<ssize_t(const char*, char*, size_t)>("readlink")(path, buffer, size);
  const std::string name = system->program.string();
  const size_t length = std::min(size, name.size());
  std::memcpy(buffer, name.data(), length);
  return static_cast<ssize_t>(length);
}

int fchown(int file, uid_t user, gid_t group) noexcept {
  auto* const system = present();
  if (system == nullptr) return real<int(int, uid_t, gid_t)>("fchown")(file, user, group);
  if (!system->may_give) return errno = EPERM, -1;
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  system->given.push_back({std::filesystem::read_symlink(link), user, group});
  return 0;
}

uid_t getuid() noexcept {
  if (auto* const system = present(); system != nullptr && system->user) return *system->user;
  return real<uid_t()>("getuid")();
}

int fchmod(int file, mode_t mode) noexcept {
  if (auto* const system = present(); system != nullptr && !system->may_change_mode) return errno = EROFS, -1;
  return real<int(int, mode_t)>("fchmod")(file, mode);
}

}  // extern "C"
