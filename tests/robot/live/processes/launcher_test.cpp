// How the robot's processes are started and stopped: in which order, with which words, how long each is
// waited for, and what is told of one that ended. Processes that a FakeSystem counts, in time that passes
// without waiting; and small scripts, for what a process finds when it begins.
#include "robot/live/session/launcher.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "robot/common/config_error.hpp"
#include "tests/robot/live/processes/fake_system.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using fake_system::ended_with;
using Lines = std::vector<std::string>;
using std::chrono::milliseconds;

constexpr std::array kPrograms{"biopsy-interlock",  "biopsy-recorder", "biopsy-supervisor", "biopsy-stage",
                               "biopsy-controller", "biopsy-console",  "biopsy-igtl",       "biopsy-ros2"};

// What waitpid tells of a process that a signal ended.
constexpr int ended_by(int signal) {
  return signal;
}

struct LauncherBench : testing::Test {
  LauncherBench() {
    fs::create_directories(folder / "programs");
    fs::create_directories(folder / "run");
    for (const char* program : kPrograms) script(program, "exit 0");
  }
  void script(const std::string& program, const std::string& commands) const {
    write_content(folder / ("programs/" + program), "#!/bin/sh\n" + commands + "\n");
    fs::permissions(folder / ("programs/" + program), fs::perms::owner_all);
  }
  void printed(const std::string& name, const std::string& text) const {
    write_content(folder / ("run/" + name + ".txt"), text);
  }
  fake_system::Child& child(const Launcher& launcher, Process process) {
    return system.children.at(launcher.pid_of(process));
  }

  const ScratchFolder folder;
  fake_system::FakeSystem system{folder / "programs/biopsy"};
};

struct LauncherOrder : LauncherBench {
  LauncherOrder() {
    launcher.start();
    launcher.start(Process::Person), launcher.start(Process::Navigation);
    launcher.start_observer("biopsy-ros2", {});
  }
  // Signals of these, as they are sent to one after the other.
  Lines terminated(const std::vector<pid_t>& pids) const {
    Lines lines;
    for (const pid_t pid : pids)
      for (const char* signal : {"CONT ", "TERM "}) lines.push_back(signal + std::to_string(pid));
    return lines;
  }
  std::vector<pid_t> pids(const std::vector<Process>& processes) const {
    std::vector<pid_t> all;
    for (const Process process : processes) all.push_back(launcher.pid_of(process));
    return all;
  }

  Launcher launcher{folder / "run", folder / "lines"};
};

TEST_F(LauncherOrder, NothingRunsBeforeInterlockAndLog) {
  EXPECT_EQ(pids({Process::Interlock, Process::Recorder, Process::Supervisor, Process::Stage,
                  Process::Controller, Process::Person, Process::Navigation}),
            std::vector<pid_t>(system.started.begin(), system.started.end() - 1));
  EXPECT_EQ(system.started.size(), 8U);
}

TEST_F(LauncherOrder, StopsObserversFirstThenTheConsoleThenTheSupervisorAndTheInterlockLast) {
  std::vector<pid_t> order =
      pids({Process::Navigation, Process::Person, Process::Supervisor, Process::Controller, Process::Stage,
            Process::Recorder, Process::Interlock});
  order.insert(order.begin(), system.started.back());
  EXPECT_EQ(launcher.stop(), Lines{});
  EXPECT_EQ(system.signals, terminated(order));
  EXPECT_TRUE(system.children.empty()) << "all were collected";
  for (const Process process : kStopOrder) EXPECT_EQ(launcher.pid_of(process), -1);
}

TEST_F(LauncherOrder, EachHasEndedBeforeTheNextIsAsked) {
  const pid_t person = launcher.pid_of(Process::Person), supervisor = launcher.pid_of(Process::Supervisor);
  system.children[person].takes = milliseconds(700);
  system.on_sleep = [&] {
    if (!system.children.contains(person)) return;
    for (const std::string& signal : system.signals)
      EXPECT_NE(signal, "TERM " + std::to_string(supervisor)) << "it retracts the needle first";
  };
  EXPECT_EQ(launcher.stop(), Lines{});
  EXPECT_GE(system.now, milliseconds(700));
  EXPECT_LE(system.now, milliseconds(710)) << "and no later than need be";
}

TEST_F(LauncherOrder, StoppingAgainAsksNobody) {
  launcher.stop();
  system.signals.clear();
  EXPECT_EQ(launcher.stop(), Lines{});
  EXPECT_EQ(system.signals, Lines{});
}

TEST_F(LauncherOrder, KillsOneThatDoesNotEndWithinTwoSecondsAndSaysSo) {
  child(launcher, Process::Stage).on_term = fake_system::kNever;
  const std::string pid = std::to_string(launcher.pid_of(Process::Stage));
  EXPECT_EQ(launcher.stop(), Lines{"biopsy-stage was ended by signal 9"});
  EXPECT_EQ(std::count(system.signals.begin(), system.signals.end(), "KILL " + pid), 1);
  EXPECT_GE(system.now, milliseconds(2'000));
  EXPECT_LE(system.now, milliseconds(2'010));
}

TEST_F(LauncherOrder, OneThatNeedsTwoSecondsIsNotKilled) {
  child(launcher, Process::Stage).takes = milliseconds(2'000);
  EXPECT_EQ(launcher.stop(), Lines{});
  for (const std::string& signal : system.signals) EXPECT_FALSE(signal.starts_with("KILL")) << signal;
}

// In the kernel, behind a disk or a board that does not answer.
TEST_F(LauncherOrder, OneThatCannotEvenBeKilledIsToldOf) {
  fake_system::Child& stage = child(launcher, Process::Stage);
  stage.on_term = stage.on_kill = fake_system::kNever;
  EXPECT_EQ(launcher.stop(), Lines{"biopsy-stage does not end"});
  EXPECT_GE(system.now, milliseconds(4'000));
  EXPECT_LE(system.now, milliseconds(4'020));
}

TEST_F(LauncherOrder, TellsOfEachThatDidNotEndWithCode0WithWhatItPrinted) {
  child(launcher, Process::Recorder).on_term = ended_with(3);
  child(launcher, Process::Controller).on_term = ended_by(SIGSEGV);
  system.children.at(system.started.back()).on_term = ended_with(1);
  printed("recorder", "starts\nerror: the disk is full\nwhere: /run\nto do: make room\n");
  printed("controller", "first\nlast words\n");
  printed("biopsy-ros2", "gone\n");
  EXPECT_EQ(launcher.stop(), (Lines{"biopsy-ros2 ended with code 1: gone",
                                    "biopsy-controller was ended by signal 11: last words",
                                    "biopsy-recorder ended with code 3\n  error: the disk is full\n  where: "
                                    "/run\n  to do: make room"}));
}

TEST_F(LauncherOrder, EndsWithItsOwner) {
  {
    Launcher other(folder / "run", folder / "lines");
    other.start(Process::Stage);
    system.signals.clear();
  }
  EXPECT_EQ(system.signals, terminated({system.started.back()}));
}

TEST_F(LauncherOrder, TellsOnceWhichOneEndedByItself) {
  EXPECT_FALSE(launcher.ended());
  EXPECT_FALSE(launcher.ended(Process::Controller));
  EXPECT_FALSE(launcher.observer_ended());
  child(launcher, Process::Controller).status = ended_with(0);
  printed("controller", "stopped\n");
  EXPECT_FALSE(launcher.ended(Process::Stage));
  EXPECT_EQ(launcher.ended(), "biopsy-controller ended with code 0: stopped");
  EXPECT_EQ(launcher.pid_of(Process::Controller), -1);
  EXPECT_FALSE(launcher.ended());
  child(launcher, Process::Interlock).status = ended_by(SIGKILL);
  EXPECT_EQ(launcher.ended(Process::Interlock), "biopsy-interlock was ended by signal 9");
  system.children.at(system.started.back()).status = ended_with(2);
  printed("biopsy-ros2", "no graph\n");
  EXPECT_EQ(launcher.observer_ended(), "biopsy-ros2 ended with code 2: no graph");
  EXPECT_FALSE(launcher.observer_ended());
  EXPECT_EQ(launcher.stop(), Lines{}) << "of those that still ran";
}

TEST_F(LauncherOrder, OfTheRobotsOwnProcessesOnlyOnesThatItStartedAreAwaited) {
  child(launcher, Process::Person).status = ended_with(0);
  EXPECT_FALSE(launcher.ended()) << "a console may be closed";
  EXPECT_EQ(launcher.ended(Process::Person), "biopsy-console ended with code 0");
}

TEST_F(LauncherBench, SaysWhatToDoWhereAProgramIsMissing) {
  fs::remove(folder / "programs/biopsy-recorder");
  Launcher launcher(folder / "run", folder / "lines");
  try {
    launcher.start();
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.what_is_wrong, "biopsy-recorder is missing");
    EXPECT_EQ(error.where, folder / "programs");
  }
  EXPECT_EQ(system.started.size(), 1U) << "the interlock";
  EXPECT_EQ(launcher.pid_of(Process::Recorder), -1);
}

TEST_F(LauncherBench, SaysWhatToDoWhereNoProcessCanBeMade) {
  system.no_more_processes = true;
  Launcher launcher(folder / "run", folder / "lines");
  try {
    launcher.start(Process::Stage);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, folder / "programs/biopsy-stage");
    EXPECT_NE(error.remedy.find("ulimit -u"), std::string::npos);
  }
  EXPECT_EQ(launcher.pid_of(Process::Stage), -1);
}

// Tests and benches lie in folders of the build's.
TEST_F(LauncherBench, FindsTheProgramsBesideItselfOrUpToTwoFoldersAbove) {
  for (const char* program : {"programs/biopsy", "programs/tests/biopsy", "programs/tests/bench/biopsy"}) {
    system.program = folder / program;
    Launcher launcher(folder / "run", folder / "lines");
    EXPECT_NO_THROW(launcher.start(Process::Supervisor)) << program;
  }
  system.program = folder / "programs/a/b/c/biopsy";
  Launcher launcher(folder / "run", folder / "lines");
  try {
    launcher.start(Process::Supervisor);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, folder / "programs/a/b/c");
  }
}

struct StartedProcess : LauncherBench {
  StartedProcess() { system.starts_real_processes = true; }
  // Waits until it ended; it is left to be collected.
  static void wait_for(pid_t pid) {
    siginfo_t info{};
    ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOWAIT), 0);
  }
  std::string output(const std::string& name) const {
    return file_content(folder / ("run/" + name + ".txt"));
  }
  std::string run(const fs::path& path) const { return (folder.path() / path).string(); }
};

TEST_F(StartedProcess, GetsItsFolderAndWhatElseIsSaid) {
  for (const char* program :
       {"biopsy-stage", "biopsy-interlock", "biopsy-console", "biopsy-igtl", "biopsy-ros2"})
    script(program, "echo \"$0 $*\"");
  Launcher launcher(folder / "run", folder / "lines");
  launcher.start(Process::Stage);
  launcher.start(Process::Interlock);
  launcher.start(Process::Person, {"--port", "80"});
  launcher.start(Process::Navigation);
  for (const Process process : {Process::Stage, Process::Interlock, Process::Person, Process::Navigation}) {
    wait_for(launcher.pid_of(process));
    EXPECT_TRUE(launcher.ended(process));
  }
  launcher.start_observer("biopsy-ros2", {"--node", "n"});
  siginfo_t info{};
  ::waitid(P_ALL, 0, &info, WEXITED | WNOWAIT);  // no other is left
  EXPECT_TRUE(launcher.observer_ended());
  EXPECT_EQ(output("stage"), run("programs/biopsy-stage") + " " + run("run") + "\n");
  EXPECT_EQ(output("interlock"), run("programs/biopsy-interlock") + " " + run("lines") + " --log-file " +
                                     run("run/interlock.log") + "\n")
      << "it knows the digital I/O only";
  EXPECT_EQ(output("person"), run("programs/biopsy-console") + " " + run("run") + " --port 80\n");
  EXPECT_EQ(output("navigation"), run("programs/biopsy-igtl") + " " + run("run") + "\n");
  EXPECT_EQ(output("biopsy-ros2"), run("programs/biopsy-ros2") + " " + run("run") + " --node n\n");
}

TEST_F(StartedProcess, PrintsIntoAFileOfItsOwnBehindWhatIsThere) {
  script("biopsy-stage", "echo out; echo err >&2; exit 7");
  Launcher launcher(folder / "run", folder / "lines");
  for (int n = 0; n < 2; ++n) {
    launcher.start(Process::Stage);
    wait_for(launcher.pid_of(Process::Stage));
    EXPECT_EQ(launcher.ended(Process::Stage), "biopsy-stage ended with code 7: err");
  }
  EXPECT_EQ(output("stage"), "out\nerr\nout\nerr\n");
  EXPECT_EQ(fs::status(folder / "run/stage.txt").permissions(),
            fs::perms::owner_read | fs::perms::owner_write);
}

// Ctrl-C at a terminal goes to the whole group of what runs there; only the launcher is to hear it.
TEST_F(StartedProcess, HasAGroupOfItsOwn) {
  script("biopsy-stage", "read -r a b c d group rest </proc/$$/stat; [ $group = $$ ] && echo leads");
  Launcher launcher(folder / "run", folder / "lines");
  launcher.start(Process::Stage);
  wait_for(launcher.pid_of(Process::Stage));
  EXPECT_EQ(output("stage"), "leads\n");
}

// A launcher may block signals for threads of its own. No shell tells: it unblocks them itself.
TEST_F(StartedProcess, HasNoSignalBlocked) {
  write_content(folder / "programs/biopsy-stage", "#!/usr/bin/env -S grep -hs ^SigBlk /proc/self/status\n");
  fs::permissions(folder / "programs/biopsy-stage", fs::perms::owner_all);
  sigset_t blocked, before;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGTERM);
  sigaddset(&blocked, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  Launcher launcher(folder / "run", folder / "lines");
  launcher.start(Process::Stage);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  wait_for(launcher.pid_of(Process::Stage));
  EXPECT_EQ(output("stage"), "SigBlk:\t0000000000000000\n");
}

TEST_F(StartedProcess, ThatIsNoProgramEndsWithCode127) {
  fs::permissions(folder / "programs/biopsy-stage", fs::perms::owner_read);
  Launcher launcher(folder / "run", folder / "lines");
  launcher.start(Process::Stage);
  wait_for(launcher.pid_of(Process::Stage));
  EXPECT_EQ(launcher.ended(Process::Stage), "biopsy-stage ended with code 127");
}

// The pipe has an end in the process: it is shut when that one is gone.
TEST_F(StartedProcess, EndsWithItsLauncherHoweverThatEnded) {
  int up[2], alive[2];
  ASSERT_EQ(::pipe(up), 0);
  ASSERT_EQ(::pipe(alive), 0);
  script("biopsy-stage", "echo up >&" + std::to_string(up[1]) + "; exec sleep 20");
  const pid_t launching = ::fork();
  if (launching == 0) {
    Launcher launcher(folder / "run", folder / "lines");
    launcher.start(Process::Stage);
    char byte = 0;
    const bool is_up = ::read(up[0], &byte, 1) == 1;
    ::_exit(is_up ? 0 : 1);  // without stopping it
  }
  ::close(up[1]), ::close(alive[1]);
  int status = 0;
  ::waitpid(launching, &status, 0);
  EXPECT_EQ(status, 0);
  pollfd shut{alive[0], POLLIN, 0};
  EXPECT_EQ(::poll(&shut, 1, 5'000), 1);
  ::close(up[0]), ::close(alive[0]);
}

// The new process asks to end with its launcher only once that one is gone.
TEST_F(StartedProcess, OfALauncherThatEndedMeanwhileDoesNotBegin) {
  int gone[2], alive[2];
  ASSERT_EQ(::pipe(gone), 0);
  ASSERT_EQ(::pipe(alive), 0);
  script("biopsy-stage", "exec sleep 20");
  const pid_t launching = ::fork();
  if (launching == 0) {
    Launcher launcher(folder / "run", folder / "lines");
    system.on_prctl = [&] {
      ::close(gone[1]);
      char byte = 0;
      (void)!::read(gone[0], &byte, 1);  // nothing: until the launcher's end is shut
    };
    launcher.start(Process::Stage);
    ::_exit(0);
  }
  ::close(gone[0]), ::close(gone[1]), ::close(alive[1]);
  ::waitpid(launching, nullptr, 0);
  pollfd shut{alive[0], POLLIN, 0};
  EXPECT_EQ(::poll(&shut, 1, 5'000), 1);
  ::close(alive[0]);
}

// Who takes it in then may have any number.
TEST_F(StartedProcess, OfAnotherParentThanItsLauncherDoesNotBegin) {
  script("biopsy-stage", "echo runs");
  Launcher launcher(folder / "run", folder / "lines");
  for (const pid_t parent : {::getpid() - 1, ::getpid() + 1}) {
    system.parent = parent;
    launcher.start(Process::Stage);
    wait_for(launcher.pid_of(Process::Stage));
    EXPECT_EQ(launcher.ended(Process::Stage), "biopsy-stage ended with code 127");
  }
}

}  // namespace
}  // namespace biopsy::robot
