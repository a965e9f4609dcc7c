// A better model takes the place of the old one: the old one stays, and trouble changes nothing.
#include "robot/cli/accepted_model.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <set>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

const std::string kOld = "[baseline]\nK = 0.8\n", kNew = "[baseline]\nK = 0.86\n",
                  kNewer = "[baseline]\nK = 0.87\n";

std::set<std::string> files_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

class AcceptedModel : public testing::Test {
 protected:
  void SetUp() override { write_content(file_, kOld); }

  // Refused, and nothing of the folder has changed.
  void expect_refused(const std::string& text, const std::string& reason) {
    const std::set<std::string> before = files_in(folder_.path());
    try {
      robot::accept_model(file_, text);
      FAIL() << "accepted";
    } catch (const ConfigError& error) {
      EXPECT_NE(error.what_is_wrong.find(reason), std::string::npos) << error.what_is_wrong;
      EXPECT_FALSE(error.remedy.empty());
    }
    EXPECT_EQ(files_in(folder_.path()), before);
    if (fs::is_regular_file(file_)) {
      EXPECT_EQ(file_content(file_), kOld);
    }
  }

  const ScratchFolder folder_;
  const fs::path file_ = folder_ / "stage.toml";
};

TEST_F(AcceptedModel, KeepsEveryOldVersionUnderItsNumber) {
  EXPECT_EQ(robot::accept_model(file_, kNew).filename(), "stage.toml.1");
  EXPECT_EQ(robot::accept_model(file_, kNewer).filename(), "stage.toml.2");
  EXPECT_EQ(file_content(file_), kNewer);
  EXPECT_EQ(file_content(folder_ / "stage.toml.1"), kOld);
  EXPECT_EQ(file_content(folder_ / "stage.toml.2"), kNew);
  EXPECT_EQ(files_in(folder_.path()), (std::set<std::string>{"stage.toml", "stage.toml.1", "stage.toml.2"}));
}

TEST_F(AcceptedModel, TakesTheFirstFreeNumberAndOverwritesNobody) {
  folder_.write("stage.toml.1", "mine");
  fs::create_symlink("nowhere", folder_ / "stage.toml.2");
  EXPECT_EQ(robot::accept_model(file_, kNew).filename(), "stage.toml.3");
  EXPECT_EQ(file_content(folder_ / "stage.toml.1"), "mine");
  EXPECT_EQ(file_content(folder_ / "stage.toml.3"), kOld);
}

TEST_F(AcceptedModel, KeepsTheModeOfTheFile) {
  const fs::perms mode = fs::perms::owner_read | fs::perms::owner_write;
  fs::permissions(file_, mode);
  const fs::path old = robot::accept_model(file_, kNew);
  EXPECT_EQ(fs::status(file_).permissions(), mode);
  EXPECT_EQ(fs::status(old).permissions(), mode);
}

TEST_F(AcceptedModel, FollowsALinkToTheFileBehindIt) {
  const ScratchFolder elsewhere;
  fs::create_symlink(file_, elsewhere / "linked.toml");
  EXPECT_EQ(robot::accept_model(elsewhere / "linked.toml", kNew),
            fs::canonical(folder_.path()) / "stage.toml.1");
  EXPECT_TRUE(fs::is_symlink(elsewhere / "linked.toml"));
  EXPECT_EQ(file_content(file_), kNew);
}

TEST_F(AcceptedModel, RefusesWhatIsNoModel) {
  expect_refused("[baseline]\nK = 86\n", "`K` = 86 is outside");
  expect_refused("[baseline", "");
  expect_refused("", "`baseline` is missing");
}

TEST_F(AcceptedModel, RefusesAFileMarkedReadOnly) {
  fs::permissions(file_, fs::perms::owner_read);
  expect_refused(kNew, "read-only");
}

TEST_F(AcceptedModel, RefusesWhereThereIsNoFile) {
  fs::remove(file_);
  expect_refused(kNew, "cannot be replaced");
  fs::create_directory(file_);
  expect_refused(kNew, "not a file");
}

TEST_F(AcceptedModel, LeavesEverythingWhereTheNewFileCannotBeWritten) {
  // A folder stands where the new file would be prepared.
  fs::create_directory(file_.string() + ".part" + std::to_string(::getpid()));
  folder_.write("stage.toml.part" + std::to_string(::getpid()) + "/full", "");
  expect_refused(kNew, "cannot be replaced");
}

TEST_F(AcceptedModel, LeavesEverythingWhereTheOldOneCannotBeKept) {
  // 255 letters are the most a name may have: there is no room for ".1".
  const fs::path longest = folder_ / (std::string(250, 'm').append(".toml"));
  write_content(longest, kOld);
  EXPECT_THROW(robot::accept_model(longest, kNew), ConfigError);
  EXPECT_EQ(file_content(longest), kOld);
}

}  // namespace
}  // namespace biopsy::cli_tests
