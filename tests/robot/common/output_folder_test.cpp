// Folders as runs leave them, one that was killed while it marked its folder included (campaign_shards kills
// one).
#include "robot/common/files/output_folder.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

TEST(RunFolder, IsTakenAgainAfterARunThatWasKilledWhileItMarkedIt) {
  const ScratchFolder folder;
  folder.write(".biopsy-run.part11119", "");
  EXPECT_NO_THROW(claim_run_folder(folder.path(), {}, {"report.json"}));
  EXPECT_TRUE(fs::exists(folder / ".biopsy-run"));
  EXPECT_FALSE(fs::exists(folder / ".biopsy-run.part11119"));
}

TEST(RunFolder, WithAFileOfAnotherOriginIsRefusedAndUntouched) {
  const ScratchFolder folder;
  folder.write("report.json", "not ours");
  folder.write(".biopsy-run.part11119", "");
  EXPECT_THROW(claim_run_folder(folder.path(), {}, {"report.json"}), ConfigError);
  EXPECT_TRUE(fs::exists(folder / "report.json"));
  EXPECT_FALSE(fs::exists(folder / ".biopsy-run"));
}

TEST(RunFolder, OfAnEarlierRunIsClearedOfItsOwnFilesOnly) {
  const ScratchFolder folder;
  claim_run_folder(folder.path(), {}, {"report.json"});
  folder.write("report.json", "of the first run");
  folder.write("notes.txt", "of a person");
  claim_run_folder(folder.path(), {}, {"report.json"});
  EXPECT_FALSE(fs::exists(folder / "report.json"));
  EXPECT_TRUE(fs::exists(folder / "notes.txt"));
}

}  // namespace
}  // namespace biopsy
