// Ctrl-C on long work, typed at a terminal: what is known until then is written, and the exit code says so.
#include "robot/common/interrupt.hpp"

#include <pty.h>
#include <unistd.h>

#include <csignal>
#include <thread>

#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

// The program at a terminal of its own.
class Terminal {
 public:
  explicit Terminal(const std::vector<std::string>& words) {
    pid_ = forkpty(&terminal_, nullptr, nullptr, nullptr);
    if (pid_ != 0) return;
    const std::string path = program();
    std::vector<const char*> arguments{path.c_str()};
    for (const std::string& word : words) arguments.push_back(word.c_str());
    arguments.push_back(nullptr);
    execv(path.c_str(), const_cast<char* const*>(arguments.data()));
    _exit(127);
  }
  ~Terminal() {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
    close(terminal_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  // False where the program ended without printing it.
  bool prints(const std::string& text) {
    while (shown_.find(text) == std::string::npos)
      if (!read_more()) return false;
    return true;
  }
  void press_ctrl_c() const { ASSERT_EQ(write(terminal_, "\x03", 1), 1); }
  int exit_code() {
    while (read_more()) {
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  const std::string& shown() const { return shown_; }

 private:
  bool read_more() {
    std::array<char, 4096> buffer{};
    const ssize_t n = read(terminal_, buffer.data(), buffer.size());
    if (n <= 0) return false;
    shown_.append(buffer.data(), static_cast<std::size_t>(n));
    return true;
  }

  int terminal_ = -1;
  pid_t pid_ = -1;
  std::string shown_;
};

struct Work {
  std::vector<std::string> words;
  std::string begun;  // printed once it is under way
  std::string json;   // file with the partial result
};

class LongWork : public testing::TestWithParam<Work> {};

TEST_P(LongWork, LeavesWhatIsKnownWhenInterrupted) {
  const ScratchFolder folder;
  const Work& work = GetParam();
  std::vector<std::string> words = work.words;
  words.insert(words.end(), {"--out", (folder / "out").string()});
  fs::copy(kSource / "docs/examples/gap", folder / "data");
  for (std::string& word : words)
    if (word.starts_with("data")) word = (folder / word).string();
  Terminal terminal(words);
  ASSERT_TRUE(terminal.prints(work.begun)) << terminal.shown();
  terminal.press_ctrl_c();
  EXPECT_EQ(terminal.exit_code(), 130) << terminal.shown();
  EXPECT_NE(terminal.shown().find("ending with what is known"), std::string::npos) << terminal.shown();
  EXPECT_NE(terminal.shown().find("out/"), std::string::npos) << "the files are named: " << terminal.shown();
  ASSERT_TRUE(fs::exists(folder / "out" / work.json)) << terminal.shown();
  const nlohmann::json partial = json_of(folder / "out" / work.json);
  // All figures take less than a second: on a busy machine the last has begun before the key arrives, and
  // nothing is left out.
  const bool was_complete = words.front() == "reproduce" && !partial.contains("left_out");
  EXPECT_TRUE(partial.value("interrupted", false) || partial.value("refusal", "") == "interrupted" ||
              was_complete)
      << partial.dump(1);
  EXPECT_TRUE(fs::exists(folder / "out/report.html") || work.json == "calibration.json");
}

INSTANTIATE_TEST_SUITE_P(
    Interrupt, LongWork,
    testing::Values(Work{{"dry-run", "liver"}, "checking the image", "report.json"},
                    Work{{"tune"}, "%", "tune.json"}, Work{{"design"}, "designs", "design.json"},
                    Work{{"calibrate"}, "searching", "calibration.json"},
                    Work{{"reproduce"}, "figure ", "reproduce.json"},
                    Work{{"gap", "data", "--model", "data/stage.toml"}, "round 1: ", "gap.json"},
                    Work{{"gap", "--paper"}, "all figures", "paper_gap.json"}),
    [](const auto& given) { return given.param.json.substr(0, given.param.json.find('.')); });

TEST(Interrupt, RequestsAStopAtTheFirstSignalAndGivesTheSignalsBack) {
  {
    const Interrupt interrupt;
    EXPECT_FALSE(interrupt.token().stop_requested());
    kill(getpid(), SIGINT);
    while (!interrupt.token().stop_requested()) std::this_thread::yield();
  }
  EXPECT_EXIT(kill(getpid(), SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST(Interrupt, EndsTheProgramAtTheSecondSignal) {
  EXPECT_EXIT(
      {
        const Interrupt interrupt;
        kill(getpid(), SIGINT);
        while (!interrupt.token().stop_requested()) std::this_thread::yield();
        kill(getpid(), SIGINT);
        while (true) std::this_thread::yield();  // work that does not look
      },
      testing::ExitedWithCode(130), "ending with what is known");
}

}  // namespace
}  // namespace biopsy::cli_tests
