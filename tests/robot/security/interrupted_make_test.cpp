// The program that makes keys, ended while it replaces a set.
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <random>

#include "robot/security/key_set.hpp"
#include "tests/robot/security/test_key_set.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;

// A real process, ended at a random moment of replacing.
TEST(MakeKeys, AnInterruptedReplacementLeavesACompleteSetOrNone) {
  std::mt19937 random(3);
  int whole = 0;
  for (int round = 0; round < 12; ++round) {
    const TestKeySet set;
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);  // or it would go on for ever after a test that is ended
      for (int i = 1;; ++i) make_keys(set.folder(), 30, now() + std::chrono::seconds(i), true);
    }
    usleep(static_cast<useconds_t>(random() % 100'000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    if (!fs::exists(set.folder())) continue;
    EXPECT_NO_THROW(check_set(set.folder(), kRoles, now() + std::chrono::minutes(1)));
    ++whole;
  }
  EXPECT_GT(whole, 0);
}

}  // namespace
}  // namespace biopsy::security
