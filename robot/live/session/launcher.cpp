#include "robot/live/session/launcher.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>
#include <thread>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPatience{2000}, kPoll{5};
constexpr int kLost = 127;  // exit code of a process that could not become its program, as of a shell's

std::string program_of(Process process) {
  if (process == Process::Person) return "biopsy-console";
  if (process == Process::Navigation) return "biopsy-igtl";
  return fmt::format("biopsy-{}", name_of(process));
}

std::string ending(int status) {
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  return fmt::format("ended with code {}", WEXITSTATUS(status));
}

bool wait_for(pid_t& pid, std::chrono::milliseconds patience, int& status) {
  for (auto waited = std::chrono::milliseconds(0); waited <= patience; waited += kPoll) {
    if (waitpid(pid, &status, WNOHANG) == pid) {
      pid = -1;
      return true;
    }
    std::this_thread::sleep_for(kPoll);
  }
  return false;
}

// SIGTERM, and SIGKILL two seconds later. Nothing: it does not even end then, two more seconds later.
std::optional<int> end(pid_t& pid) {
  int status = 0;
  kill(pid, SIGCONT);  // a stopped process takes no SIGTERM
  for (const int signal : {SIGTERM, SIGKILL}) {
    kill(pid, signal);
    if (wait_for(pid, kPatience, status)) return status;
  }
  return std::nullopt;
}

// Errors that a program printed, or its last line.
std::string last_message(const fs::path& output) {
  std::istringstream file(read_file_if_present(output));
  std::string words;
  std::string last;
  bool error = false;
  for (std::string line; std::getline(file, line);) {
    error = error || line.starts_with("error:");
    if (error) words += "\n  " + line;
    last = line;
  }
  return words.empty() && !last.empty() ? ": " + last : words;
}

fs::path output_of(const fs::path& run_folder, std::string_view name) {
  return run_folder / fmt::format("{}.txt", name);
}

std::optional<std::string> ended_by_itself(const std::string& program, const fs::path& output, pid_t& pid) {
  int status = 0;
  if (pid < 0 || waitpid(pid, &status, WNOHANG) != pid) return std::nullopt;
  pid = -1;
  return fmt::format("{} {}{}", program, ending(status), last_message(output));
}

// Folder of this program, or above it for tests and benches.
fs::path programs_folder() {
  fs::path own = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& folder : {own, own.parent_path(), own.parent_path().parent_path()})
    if (fs::exists(folder / program_of(Process::Supervisor))) return folder;
  return own;
}

// In the child between fork and exec: async-signal-safe calls only.
[[noreturn]] void become(char* const* words, const char* output, pid_t launcher) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);         // ends with its parent,
  if (getppid() != launcher) _exit(kLost);  // also where that ended just now
  const sigset_t none{};
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C goes to the launcher only, which stops it in order
  const int file = open(output, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  dup2(file, STDOUT_FILENO);  // where it could not be opened they stay as they were
  dup2(file, STDERR_FILENO);
  execv(words[0], words);
  _exit(kLost);
}

}  // namespace

Launcher::Launcher(fs::path run_folder, fs::path lines_folder)
    : run_folder_(std::move(run_folder)),
      lines_folder_(std::move(lines_folder)),
      programs_(programs_folder()) {
  pids_.fill(-1);
}

Launcher::~Launcher() {
  stop();
}

void Launcher::start() {
  for (const Process process : kStartOrder) start(process);
}

pid_t Launcher::spawn(const std::string& program, std::vector<std::string> words,
                      const fs::path& output) const {
  const fs::path path = programs_ / program;
  if (!fs::exists(path))
    throw ConfigError(fmt::format("{} is missing", program), programs_.string(),
                      "install biopsy-live; of a source tree: cmake --build build/dev --target programs");
  words.insert(words.begin(), path.string());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string file = output.string();
  const pid_t launcher = getpid();
  const pid_t pid = fork();
  if (pid == 0) become(pointers.data(), file.c_str(), launcher);
  if (pid < 0)
    throw ConfigError("no new process can be made", path.string(), "see `ulimit -u` and free memory");
  return pid;
}

void Launcher::start(Process process, const std::vector<std::string>& more) {
  // The interlock uses the digital I/O only.
  std::vector<std::string> words{(process == Process::Interlock ? lines_folder_ : run_folder_).string()};
  if (process == Process::Interlock)
    words.insert(words.end(), {"--log-file", (run_folder_ / "interlock.log").string()});
  words.insert(words.end(), more.begin(), more.end());
  pids_[static_cast<std::size_t>(process)] =
      spawn(program_of(process), std::move(words), output_of(run_folder_, name_of(process)));
}

void Launcher::start_observer(const std::string& program, const std::vector<std::string>& more) {
  std::vector<std::string> words{run_folder_.string()};
  words.insert(words.end(), more.begin(), more.end());
  observers_[program] = spawn(program, std::move(words), output_of(run_folder_, program));
}

std::vector<std::string> Launcher::stop() {
  std::vector<std::string> trouble;
  const auto stop_one = [&](const std::string& program, const fs::path& output, pid_t& pid) {
    if (pid < 0) return;
    const std::optional<int> status = end(pid);
    if (!status)
      trouble.push_back(fmt::format("{} does not end", program));
    else if (!WIFEXITED(*status) || WEXITSTATUS(*status) != 0)
      trouble.push_back(fmt::format("{} {}{}", program, ending(*status), last_message(output)));
  };
  for (auto& [program, pid] : observers_) stop_one(program, output_of(run_folder_, program), pid);
  for (const Process process : kStopOrder)
    stop_one(program_of(process), output_of(run_folder_, name_of(process)),
             pids_[static_cast<std::size_t>(process)]);
  return trouble;
}

std::optional<std::string> Launcher::ended() {
  for (const Process process : kStartOrder)
    if (auto how = ended(process)) return how;
  return std::nullopt;
}

std::optional<std::string> Launcher::ended(Process process) {
  return ended_by_itself(program_of(process), output_of(run_folder_, name_of(process)),
                         pids_[static_cast<std::size_t>(process)]);
}

std::optional<std::string> Launcher::observer_ended() {
  for (auto& [program, pid] : observers_)
    if (auto how = ended_by_itself(program, output_of(run_folder_, program), pid)) return how;
  return std::nullopt;
}

}  // namespace biopsy::robot
