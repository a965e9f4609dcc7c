// Who owns what of an installed robot. Inputs: run folders as `biopsy up --prepare` writes them; what the
// kernel then permits is tested with real users by tests/installation/claims.
#include "robot/live/session/ownership.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <map>

#include "drivers/digital_io/shared_io.hpp"
#include "robot/common/config_error.hpp"
#include "robot/security/make_keys.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

class OwnershipOfFiles : public testing::Test {
 protected:
  OwnershipOfFiles() {
    fs::create_directories(folder_ / "run/planning");
    fs::create_directories(folder_ / "lines");
    write_content(folder_ / "run/live.json", "{}");
    write_content(folder_ / "run/planning/slice_0001.dcm", "image");
    fs::create_directory_symlink(folder_ / "lines", folder_ / "run/lines");
    digital_io::create_shared_io(folder_ / "lines");
    security::make_keys(folder_ / "run/keys", 1,
                        std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()), false);
    settings_.keys = folder_ / "run/keys";
    settings_.lines = folder_ / "lines";
  }

  std::map<std::string, Ownership> owners() const {
    std::map<std::string, Ownership> owners;
    for (const Ownership& file : ownership_of(folder_ / "run", settings_)) {
      const auto [_, is_new] = owners.emplace(fs::relative(file.path, folder_.path()).string(), file);
      EXPECT_TRUE(is_new) << file.path << " has two owners";
    }
    return owners;
  }

  ScratchFolder folder_;
  live::LiveSettings settings_;
};

TEST_F(OwnershipOfFiles, ItsOwnerCanUseEachFileAndPassEachFolder) {
  const auto modes = owners();
  for (const auto& [name, mode] : {std::pair{"run", 0750U},
                                   {"run/live.json", 0640U},
                                   {"run/planning", 0750U},
                                   {"run/planning/slice_0001.dcm", 0640U},
                                   {"run/keys/stage", 0700U},
                                   {"run/keys/recorder/signing_key.pem", 0600U},
                                   {"lines", 0711U},
                                   {"lines/stage", 0640U}})
    EXPECT_EQ(modes.at(name).mode, mode) << name;
}

TEST_F(OwnershipOfFiles, ListsThemInTheSameOrderOnEveryDisk) {
  for (const char* name : {"b", "d", "a", "e", "c"}) write_content(folder_ / "run/planning" / name, name);
  std::vector<fs::path> listed;
  for (const Ownership& file : ownership_of(folder_ / "run", settings_))
    if (file.path.parent_path().filename() == "planning") listed.push_back(file.path);
  ASSERT_EQ(listed.size(), 6U);
  EXPECT_TRUE(std::is_sorted(listed.begin(), listed.end()));
}

TEST_F(OwnershipOfFiles, LeavesNoFileOut) {
  const auto owners_of_all = owners();
  std::size_t found = 0;
  for (const char* root : {"run", "lines"})
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / root)) {
      if (entry.is_symlink()) continue;
      ++found;
      EXPECT_TRUE(owners_of_all.contains(fs::relative(entry.path(), folder_.path()).string()))
          << entry.path();
    }
  EXPECT_EQ(owners_of_all.size(), found + 2) << "and the two folders";
}

TEST_F(OwnershipOfFiles, GivesKeysToTheirProcessAndNobodyElse) {
  verifies("R-68");
  for (const auto& [name, file] : owners()) {
    if (!name.starts_with("run/keys/")) continue;
    EXPECT_EQ(file.mode & 077U, 0U) << name;
    const std::string role = name.substr(9, name.find('/', 9) - 9);
    const bool is_process = role == "stage" || role == "controller" || role == "supervisor" ||
                            role == "recorder" || role == "console" || role == "navigation" ||
                            role == "observer" || role == "mcap" || role == "confirmer";
    EXPECT_EQ(file.user, is_process ? "biopsy-" + role : "root") << name;
  }
  EXPECT_EQ(owners().at("run/keys").mode, 0711U) << "others may pass, but not list or add";
}

TEST_F(OwnershipOfFiles, LetsOnlyRootWriteSettingsAndImages) {
  verifies("R-68");
  for (const char* name : {"run", "run/live.json", "run/planning", "run/planning/slice_0001.dcm"}) {
    const Ownership file = owners().at(name);
    EXPECT_EQ(file.user, "root");
    EXPECT_EQ(file.group, kReadersGroup);
    EXPECT_EQ(file.mode & 027U, 0U) << name;
  }
}

TEST_F(OwnershipOfFiles, LetsEachDriveItsOwnLinesAndThreeReadThem) {
  verifies("R-68");
  for (const char* process : {"stage", "supervisor", "interlock"}) {
    const Ownership file = owners().at(std::string("lines/") + process);
    EXPECT_EQ(file.user, std::string("biopsy-") + process);
    EXPECT_EQ(file.group, kIoGroup);
    EXPECT_EQ(file.mode, 0640U);
  }
  EXPECT_EQ(owners().at("lines").mode & 022U, 0U);
}

TEST_F(OwnershipOfFiles, KeepsTheConsoleFromTheKeysOfARealStage) {
  verifies("R-68");
  EXPECT_EQ(owners().at("lines/panel").user, "biopsy-console")
      << "the page turns the keys of a simulated one";
  settings_.device = "nidaqmx";
  EXPECT_EQ(owners().at("lines/panel").user, "biopsy-stage");
}

TEST_F(OwnershipOfFiles, NeverFollowsALink) {
  write_content(folder_ / "secret", "of somebody else");
  fs::permissions(folder_ / "secret", fs::perms::owner_read);
  fs::create_symlink(folder_ / "secret", folder_ / "link");
  const Ownership link{folder_ / "link", "root", "root", 0644};
  EXPECT_THROW(give_to_owners({link}), ConfigError);
  EXPECT_EQ(fs::status(folder_ / "secret").permissions(), fs::perms::owner_read);
}

TEST_F(OwnershipOfFiles, IsRefusedForUsersThatDoNotExist) {
  try {
    give_to_owners({{folder_ / "run/live.json", "biopsy-nobody-here", "root", 0640}});
    FAIL();
  } catch (const ConfigError& error) {
    EXPECT_NE(error.what_is_wrong.find("biopsy-nobody-here"), std::string::npos);
    EXPECT_NE(error.remedy.find("systemd-sysusers"), std::string::npos);
  }
}

}  // namespace
}  // namespace biopsy::robot
