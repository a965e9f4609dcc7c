#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <map>

#include "robot/common/config_error.hpp"
#include "robot/common/files/atomic_directory.hpp"
#include "robot/security/check_keys.hpp"
#include "robot/security/key_set.hpp"
#include "tests/robot/security/test_key_set.hpp"

namespace biopsy::security {
namespace {

namespace fs = std::filesystem;
using std::chrono::days;

std::map<fs::path, std::string> contents(const fs::path& folder) {
  std::map<fs::path, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    all[entry.path().lexically_relative(folder)] = entry.is_regular_file() ? file_content(entry.path()) : "";
  return all;
}

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

TEST(MakeKeys, AFreshSetIsGoodForEveryRoleUntilItsEnd) {
  const TestKeySet set(now(), 30);
  for (const Role role : kRoles) {
    EXPECT_NEAR(static_cast<double>((check_keys(set.folder(), role, now()) - now()).count()), 30 * 86400.0,
                60.0);
    EXPECT_NO_THROW(check_keys(set.folder(), role, now() + days(30) - std::chrono::minutes(2)));
    EXPECT_THROW(check_keys(set.folder(), role, now() + days(30) + std::chrono::minutes(2)), ConfigError);
    EXPECT_NO_THROW(check_keys(set.folder(), role, now() - std::chrono::minutes(50)))
        << "a clock that is behind";
    EXPECT_THROW(check_keys(set.folder(), role, now() - std::chrono::minutes(70)), ConfigError);
  }
  for (const Signer signer : kSigners) EXPECT_NO_THROW(check_signing_keys(set.folder(), signer));
}

TEST(MakeKeys, FilesArePrivateToTheOwner) {
  const mode_t usual = umask(0);
  const TestKeySet set;
  umask(usual);
  struct stat facts {};
  ASSERT_EQ(stat(set.folder().c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 07777U, 0700U);
  for (const auto& entry : fs::recursive_directory_iterator(set.folder())) {
    ASSERT_EQ(stat(entry.path().c_str(), &facts), 0);
    EXPECT_EQ(facts.st_mode & 07777U, entry.is_directory() ? 0700U : 0600U) << entry.path();
  }
}

TEST(MakeKeys, KeepsAnExistingSet) {
  const TestKeySet set;
  const auto before = contents(set.folder());
  EXPECT_THROW(make_keys(set.folder(), 30, now(), false), ConfigError);
  EXPECT_EQ(contents(set.folder()), before);
  EXPECT_EQ(entries(set.folder().parent_path()), 1U) << "no partial set is left behind";
}

TEST(MakeKeys, ReplacingKeepsTheOldSetAside) {
  const TestKeySet set;
  const auto before = contents(set.folder());
  const auto later = now() + days(1);
  const MadeKeys made = make_keys(set.folder().string() + "/", 60, later, true);
  ASSERT_TRUE(made.old_set);
  EXPECT_TRUE(made.old_set->filename().string().starts_with("keys.2")) << *made.old_set;
  EXPECT_EQ(contents(*made.old_set), before);
  EXPECT_NE(contents(set.folder()), before);
  EXPECT_NO_THROW(check_keys(set.folder(), Role::Stage, later));
  EXPECT_THROW(make_keys(set.folder(), 60, later, true), ConfigError) << "the same second";
  EXPECT_EQ(entries(set.folder().parent_path()), 2U);
}

TEST(MakeKeys, AFolderWithOtherFilesIsNeverMovedAside) {
  const ScratchFolder scratch;
  scratch.write("thesis.tex", "years of work");
  EXPECT_THROW(make_keys(scratch.path(), 30, now(), true), ConfigError);
  EXPECT_THROW(make_keys(scratch / "thesis.tex", 30, now(), true), ConfigError);
  EXPECT_EQ(file_content(scratch / "thesis.tex"), "years of work");
  fs::create_directory(scratch / "empty");
  EXPECT_NO_THROW(make_keys(scratch / "empty", 30, now(), false));
}

TEST(MakeKeys, ADirectoryThatCannotBePutInPlaceLeavesNoTrace) {
  const ScratchFolder scratch;
  {
    AtomicDirectory fresh(scratch / "keys");
    fresh.write(fresh.path() / "stage" / "identity_key.pem", "secret");
    EXPECT_THROW(fresh.write(fresh.path() / "stage" / "identity_key.pem", "again"), ConfigError);
    fs::create_directory(scratch / "keys");
    scratch.write("keys/theirs", "came first");
    EXPECT_THROW(fresh.settle(std::nullopt), ConfigError);
    EXPECT_THROW(fresh.settle(scratch / "nowhere" / "aside"), ConfigError);
  }
  EXPECT_EQ(entries(scratch.path()), 1U);
  EXPECT_EQ(file_content(scratch / "keys/theirs"), "came first");
}

TEST(MakeKeys, DaysAreCheckedForTheirRange) {
  const ScratchFolder scratch;
  for (const int wrong : {-1, 0, 3651, 2000000000})
    EXPECT_THROW(make_keys(scratch / "keys", wrong, now(), false), ConfigError);
  EXPECT_EQ(entries(scratch.path()), 0U);
  for (const int right : {1, 3650})
    EXPECT_NO_THROW(make_keys(scratch / std::to_string(right), right, now(), false));
}

TEST(MakeKeys, AFolderThatCannotBeWrittenIsNamed) {
  const ScratchFolder scratch;
  scratch.write("file", "");
  try {
    make_keys(scratch / "file" / "keys", 30, now(), false);
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(error.where.find("file"), std::string::npos);
  }
}

TEST(MakeKeys, TheDefaultFolderFollowsTheXdgSpecification) {
  const std::string home = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  setenv("HOME", "/home/ada", 1);
  unsetenv("XDG_CONFIG_HOME");
  EXPECT_EQ(default_folder(), "/home/ada/.config/biopsy/keys");
  setenv("XDG_CONFIG_HOME", "relative", 1);
  EXPECT_EQ(default_folder(), "/home/ada/.config/biopsy/keys");
  setenv("XDG_CONFIG_HOME", "/etc/xdg", 1);
  EXPECT_EQ(default_folder(), "/etc/xdg/biopsy/keys");
  unsetenv("XDG_CONFIG_HOME");
  unsetenv("HOME");
  EXPECT_THROW(default_folder(), ConfigError);
  setenv("HOME", home.c_str(), 1);
}

TEST(MakeKeys, TwoSetsHaveNothingInCommon) {
  const TestKeySet one, two;
  const auto first = contents(one.folder()), second = contents(two.folder());
  ASSERT_EQ(first.size(), second.size());
  for (const auto& [name, content] : first)
    EXPECT_TRUE(content.empty() || content != second.at(name)) << name;
}

}  // namespace
}  // namespace biopsy::security
