// That files get the owner and the mode that are listed for them. Users are those of any Debian; the change
// of owner is noted, so that no test needs to be root.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "robot/common/config_error.hpp"
#include "robot/live/session/ownership.hpp"
#include "tests/robot/live/processes/fake_system.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

struct GivenToOwners : testing::Test {
  GivenToOwners() {
    write_content(folder / "file", "x");
    fs::create_directories(folder / "inner");
  }
  static mode_t mode_of(const fs::path& path) {
    struct stat status {};
    ::stat(path.c_str(), &status);
    return status.st_mode & 07777U;
  }
  static std::string refusal(const Ownership& file) {
    try {
      give_to_owners({file});
    } catch (const ConfigError& error) {
      return error.what_is_wrong + " | " + error.where;
    }
    return "";
  }

  const ScratchFolder folder;
  fake_system::FakeSystem system{""};
};

TEST_F(GivenToOwners, EachFileGetsItsUserGroupAndMode) {
  give_to_owners({{folder / "file", "man", "sys", 0640}, {folder / "inner", "root", "daemon", 0711}});
  ASSERT_EQ(system.given.size(), 2U);
  EXPECT_EQ(system.given[0].path, fs::canonical(folder / "file"));
  EXPECT_EQ(system.given[0].user, 6U) << "man's, whose group has another number";
  EXPECT_EQ(system.given[0].group, 3U) << "of sys";
  EXPECT_EQ(system.given[1].path, fs::canonical(folder / "inner"));
  EXPECT_EQ(system.given[1].user, 0U);
  EXPECT_EQ(system.given[1].group, 1U);
  EXPECT_EQ(mode_of(folder / "file"), 0640U);
  EXPECT_EQ(mode_of(folder / "inner"), 0711U);
}

TEST_F(GivenToOwners, IsRefusedWhereTheKernelRefusesIt) {
  fs::permissions(folder / "file", fs::perms::owner_read);
  system.may_give = false;
  EXPECT_EQ(refusal({folder / "file", "root", "root", 0640}),
            "cannot be given to its owner: Operation not permitted | " + (folder / "file").string());
  EXPECT_EQ(mode_of(folder / "file"), 0400U) << "of another's file the mode stays";
  system.may_give = true;
  system.may_change_mode = false;
  EXPECT_EQ(refusal({folder / "file", "root", "root", 0640}),
            "cannot be given to its owner: Read-only file system | " + (folder / "file").string());
  EXPECT_EQ(refusal({folder / "gone", "root", "root", 0640}),
            "cannot be given to its owner: No such file or directory | " + (folder / "gone").string());
}

TEST_F(GivenToOwners, IsRefusedForAGroupThatDoesNotExist) {
  EXPECT_EQ(refusal({folder / "file", "root", "biopsy-nobody-here", 0640}),
            "there is no group biopsy-nobody-here | " + (folder / "file").string());
  EXPECT_TRUE(system.given.empty());
}

// Nobody may ever open its other end.
TEST_F(GivenToOwners, APipeHoldsNothingUp) {
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  give_to_owners({{folder / "pipe", "root", "root", 0640}});
  EXPECT_EQ(mode_of(folder / "pipe"), 0640U);
}

TEST_F(GivenToOwners, NoDescriptorIsLeftOpen) {
  const auto open_files = [] {
    return std::distance(fs::directory_iterator("/proc/self/fd"), fs::directory_iterator{});
  };
  const auto before = open_files();
  give_to_owners({{folder / "file", "root", "root", 0640}});
  system.may_give = false;
  EXPECT_NE(refusal({folder / "file", "root", "root", 0640}), "");
  EXPECT_EQ(open_files(), before);
}

}  // namespace
}  // namespace biopsy::robot
