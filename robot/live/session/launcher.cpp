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

std::string program_of(Process process) {
  if (process == Process::Person) return "biopsy-console";
  if (process == Process::Navigation) return "biopsy-igtl";
  return fmt::format("biopsy-{}", name_of(process));
}

std::string ending(int status) {
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  return fmt::format("ended with code {}", WEXITSTATUS(status));
}

// Folder of this program, or above it for tests and benches.
fs::path programs_folder() {
  fs::path own = fs::read_symlink("/proc/self/exe").parent_path();
  for (const fs::path& folder : {own, own.parent_path(), own.parent_path().parent_path()})
    if (fs::exists(folder / program_of(Process::Supervisor))) return folder;
  return own;
}

// In the child between fork and exec: async-signal-safe calls only.
[[noreturn]] void become(char* const* words, const char* output) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);  // ends with its parent
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  setpgid(0, 0);  // Ctrl-C goes to the launcher only, which stops it in order
  const int file = open(output, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file >= 0) {
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
  }
  execv(words[0], words);
  _exit(127);
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

void Launcher::start(Process process, const std::vector<std::string>& more) {
  const fs::path program = programs_ / program_of(process);
  if (!fs::exists(program))
    throw ConfigError(fmt::format("{} is missing", program_of(process)), programs_.string(),
                      "install biopsy-live, or build all programs into one folder");
  // The interlock uses the digital I/O only.
  std::vector<std::string> words{program.string(),
                                 (process == Process::Interlock ? lines_folder_ : run_folder_).string()};
  if (process == Process::Interlock)
    words.insert(words.end(), {"--log-file", (run_folder_ / "interlock.log").string()});
  words.insert(words.end(), more.begin(), more.end());
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const std::string output = (run_folder_ / fmt::format("{}.txt", name_of(process))).string();
  const pid_t pid = fork();
  if (pid == 0) become(pointers.data(), output.c_str());
  if (pid < 0)
    throw ConfigError("no new process can be made", program.string(), "see `ulimit -u` and free memory");
  pids_[static_cast<std::size_t>(process)] = pid;
}

bool Launcher::wait_for(Process process, std::chrono::milliseconds patience, int& status) {
  pid_t& pid = pids_[static_cast<std::size_t>(process)];
  for (auto waited = std::chrono::milliseconds(0); waited <= patience; waited += kPoll) {
    if (waitpid(pid, &status, WNOHANG) == pid) {
      pid = -1;
      return true;
    }
    std::this_thread::sleep_for(kPoll);
  }
  return false;
}

std::vector<std::string> Launcher::stop() {
  std::vector<std::string> trouble;
  for (const Process process : kStopOrder) {
    const pid_t pid = pid_of(process);
    if (pid < 0) continue;
    int status = 0;
    kill(pid, SIGCONT);  // a stopped process takes no SIGTERM
    kill(pid, SIGTERM);
    if (!wait_for(process, kPatience, status)) {
      kill(pid, SIGKILL);
      wait_for(process, kPatience, status);
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      trouble.push_back(fmt::format("{} {}{}", program_of(process), ending(status), last_message(process)));
  }
  return trouble;
}

std::string Launcher::last_message(Process process) const {
  std::istringstream file(read_file_if_present(run_folder_ / fmt::format("{}.txt", name_of(process))));
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

std::optional<std::string> Launcher::ended() {
  for (const Process process : kStartOrder)
    if (auto how = ended(process)) return how;
  return std::nullopt;
}

std::optional<std::string> Launcher::ended(Process process) {
  pid_t& pid = pids_[static_cast<std::size_t>(process)];
  int status = 0;
  if (pid < 0 || waitpid(pid, &status, WNOHANG) != pid) return std::nullopt;
  pid = -1;
  return fmt::format("{} {}{}", program_of(process), ending(status), last_message(process));
}

}  // namespace biopsy::robot
