#include "robot/common/subprocess.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>

extern char** environ;

namespace biopsy {
namespace {

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

// What the program is to read: a file without a name, so that neither side waits for the other.
File file_of(const std::string& input) {
  File file(std::tmpfile());
  if (file == nullptr) return file;
  std::fwrite(input.data(), 1, input.size(), file.get());
  std::rewind(file.get());
  return file;
}

pid_t start(const std::vector<std::string>& words, int input, int output, bool with_errors) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  if (with_errors)
    posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  else
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error == 0 ? pid : -1;
}

int exit_code_of(pid_t pid) {
  int status = 0;
  if (waitpid(pid, &status, 0) != pid) return 127;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string everything_from(int descriptor, const std::function<void()>& while_running) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (;;) {
    pollfd waiting{descriptor, POLLIN, 0};
    const int ready = poll(&waiting, 1, 100);
    while_running();
    if (ready == 0) continue;
    const ssize_t count = read(descriptor, buffer.data(), buffer.size());
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

ProcessResult run_subprocess(const std::vector<std::string>& words, const std::string& input,
                             bool with_errors, const std::function<void()>& while_running) {
  const File given = file_of(input);
  std::array<int, 2> pipe_ends{};
  if (given == nullptr || pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return {};
  const pid_t pid = start(words, fileno(given.get()), pipe_ends[1], with_errors);
  close(pipe_ends[1]);
  ProcessResult spoken;
  if (pid > 0) {
    spoken.text = everything_from(pipe_ends[0], while_running);
    spoken.exit_code = exit_code_of(pid);
  }
  close(pipe_ends[0]);
  return spoken;
}

}  // namespace biopsy
