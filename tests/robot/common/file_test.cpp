#include "robot/common/files/file.hpp"

#include <gtest/gtest.h>

#include "robot/common/config_error.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& file) {
  try {
    read_file(file, "a remedy");
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.where, file.string());
    EXPECT_EQ(error.remedy, "a remedy");
    return error.what_is_wrong;
  }
  return "accepted";
}

TEST(File, ComesBackAsItWasWritten) {
  const ScratchFolder folder;
  for (const std::string& content : {std::string(), std::string("a\0\r\n\xFF", 5), std::string(1 << 20, 'x'),
                                     std::string((3 << 20) + 7, 'y')}) {
    atomic_write(folder / "deep/er/file", content);
    EXPECT_EQ(read_file(folder / "deep/er/file"), content);
  }
}

TEST(File, RefusesWhatIsMissingOrAFolder) {
  const ScratchFolder folder;
  EXPECT_EQ(refusal(folder / "none"), "cannot be read: No such file or directory");
  EXPECT_EQ(refusal(folder.path()), "cannot be read: Is a directory");
  EXPECT_EQ(refusal("/dev/zero"), "is larger than 1 GB");  // never ends
  EXPECT_EQ(read_file_if_present(folder / "none"), "");
}

TEST(AtomicWrite, LeavesTheOldFileAndNoOtherWhereItFails) {
  const ScratchFolder folder;
  folder.write("file", "old");
  EXPECT_THROW(atomic_write(folder / "file/below", "new"), ConfigError);
  fs::create_directory(folder / "folder");
  folder.write("folder/inside", "kept");
  EXPECT_THROW(atomic_write(folder / "folder", "new"), ConfigError);
  EXPECT_EQ(read_file(folder / "file"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

}  // namespace
}  // namespace biopsy
