// The shared I/O files: initial state, owners, and which files are refused.
#include "drivers/digital_io/shared_io.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <random>
#include <string>

#include "drivers/digital_io/io_views.hpp"
#include "robot/common/config_error.hpp"
#include "tests/drivers/digital_io/high_voltage.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::digital_io {
namespace {

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    EXPECT_FALSE(error.where.empty() || error.remedy.empty());
    return error.what_is_wrong;
  }
  return "";
}

std::string refusal_to_attach(const std::filesystem::path& folder) {
  return refusal([&] { const IoReader reader(folder); });
}

constexpr std::int64_t kNow_ns = 5'000'000'000;

class SharedIoFile : public testing::Test {
 protected:
  SharedIoFile() { create_shared_io(folder_.path()); }
  std::filesystem::path file() const { return folder_ / "stage"; }

  ScratchFolder folder_;
};

TEST_F(SharedIoFile, AreZeroWhenMade) {
  const IoReader reader(folder_.path());
  EXPECT_EQ(reader.converter(), ConverterOutput{});
  EXPECT_EQ(reader.panel(0).levels, PanelLevels{}) << "E-stop pressed";
  EXPECT_FALSE(reader.panel(0).read);
  EXPECT_EQ(reader.relay().output, RelayOutput{});
  EXPECT_EQ(reader.relay().ticks, 0U);
  for (const std::int64_t now_ns : {0L, 1L, 1'000'000'000'000L})
    EXPECT_EQ(reader.load_voltage_seen_mV(now_ns), 0);
}

TEST_F(SharedIoFile, HaveAFixedLayoutAndNoOtherUserMayOpenThem) {
  EXPECT_EQ(offsetof(StageOutputs, pulses), 8U);
  EXPECT_EQ(offsetof(InterlockOutputs, ticks), 32U);
  for (const Owner owner : kOwners) {
    const std::filesystem::path file = folder_.path() / name_of(owner);
    const std::string content = file_content(file);
    ASSERT_EQ(content.size(), kFileSize);
    EXPECT_EQ(content.substr(1, 7), "biopsyl");
    EXPECT_EQ(content.find_first_not_of('\0', 16), std::string::npos) << "nothing but the title is set";
    struct stat status {};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), kOwners.size())
      << "nothing left over";
}

TEST_F(SharedIoFile, CarryWhatEachOwnerWrites) {
  const IoReader reader(folder_.path());
  StageIo stage(folder_.path());
  SupervisorIo supervisor(folder_.path());
  InterlockIo interlock(folder_.path());
  PanelIo panel(folder_.path());
  stage.write(high_voltage(-2'400'000));
  stage.pulse();
  for (int i = 0; i < 3; ++i) supervisor.pulse();
  EXPECT_EQ(reader.converter(), (ConverterOutput{-2'400'000, true}));
  EXPECT_EQ(reader.stage_pulses(), 1U);
  EXPECT_EQ(reader.supervisor_pulses(), 3U);
  for (int levels = 0; levels < 128; ++levels) {
    const auto level = [levels](int wire) { return (levels >> wire & 1) != 0; };
    PanelLevels set{level(0), level(1), level(2), level(3), level(4), level(5), level(6)};
    panel.set(set);
    stage.mark_panel_read(kNow_ns);
    set.relay_closed = set.relay_closed && set.relay_wired;  // there is no process
    EXPECT_EQ(reader.panel(kNow_ns).levels, set);
  }
  interlock.write({-2'400'000, true}, 1'000);
  interlock.write({-2'400'000, true}, 2'000);
  EXPECT_EQ(reader.relay().output, (RelayOutput{-2'400'000, true}));
  EXPECT_EQ(reader.relay().changed_ns, 1'000);
  EXPECT_EQ(reader.relay().zero_ns, 0);
  interlock.write({0, true}, 3'000);
  interlock.write({0, false}, 4'000);
  EXPECT_EQ(reader.relay().output, RelayOutput{});
  EXPECT_EQ(reader.relay().changed_ns, 3'000);
  EXPECT_EQ(reader.relay().zero_ns, 3'000);
  EXPECT_EQ(reader.relay().ticked_ns, 4'000);
  EXPECT_EQ(reader.relay().ticks, 4U);
}

TEST(IoWords, KeepEveryVoltage) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int32_t> any(std::numeric_limits<std::int32_t>::min());
  for (int i = 0; i < 10'000; ++i) {
    const std::int32_t mV = any(random);
    for (const bool on : {false, true}) {
      EXPECT_EQ(voltage_mV(packed(mV, on)), mV);
      EXPECT_EQ(flag(packed(mV, on)), on);
    }
  }
}

TEST_F(SharedIoFile, StageStartsAtZeroVolts) {
  const IoReader reader(folder_.path());
  std::optional<StageIo> stage(folder_.path());
  stage->write(high_voltage(8'000'000));
  stage->pulse();
  stage.reset();
  EXPECT_EQ(reader.converter(), (ConverterOutput{8'000'000, true})) << "a converter holds its last value";
  stage.emplace(folder_.path());
  EXPECT_EQ(reader.converter(), ConverterOutput{});
  EXPECT_EQ(reader.stage_pulses(), 1U) << "a start is no pulse";
}

TEST_F(SharedIoFile, PanelStartsWithKeysOffAndTheEStopPressed) {
  const IoReader reader(folder_.path());
  std::optional<PanelIo> panel(folder_.path());
  StageIo stage(folder_.path());
  stage.mark_panel_read(kNow_ns);
  panel->set({true, true, true, true, true, true});
  panel.reset();
  EXPECT_NE(reader.panel(kNow_ns).levels, PanelLevels{});
  panel.emplace(folder_.path());
  EXPECT_EQ(reader.panel(kNow_ns).levels, PanelLevels{});
}

TEST_F(SharedIoFile, APanelThatTheDriverHasNotReadForTwentyMillisecondsIsUnread) {
  const IoReader reader(folder_.path());
  StageIo stage(folder_.path());
  PanelIo panel(folder_.path());
  panel.set({.arm_key = true, .estop_a_closed = true, .estop_b_closed = true});
  EXPECT_FALSE(reader.panel(kNow_ns).read) << "never";
  EXPECT_EQ(reader.panel(kNow_ns).age_us, -1);
  stage.mark_panel_read(kNow_ns);
  for (const std::int64_t later_ns : {0L, 19'999'999L, -19'999'999L})
    EXPECT_TRUE(reader.panel(kNow_ns + later_ns).read);
  for (const std::int64_t later_ns : {0L, 700'000L, 19'999'999L, 20'000'000L, 143'000'000L})
    EXPECT_EQ(reader.panel(kNow_ns + later_ns).age_us, later_ns / 1'000);
  for (const std::int64_t later_ns : {20'000'000L, -20'000'000L, 1'000'000'000L}) {
    EXPECT_FALSE(reader.panel(kNow_ns + later_ns).read);
    EXPECT_EQ(reader.panel(kNow_ns + later_ns).levels, PanelLevels{}) << "keys off, emergency stop pressed";
  }
}

struct RelaysContact : SharedIoFile {
  const IoReader reader{folder_.path()};
  StageIo stage{folder_.path()};
  InterlockIo interlock{folder_.path()};
  PanelIo panel{folder_.path()};

  bool closed(std::int64_t now_ns) {
    stage.mark_panel_read(now_ns);
    return reader.panel(now_ns).levels.relay_closed;
  }
};

TEST_F(RelaysContact, IsThatOfItsProcessWhileThatLives) {
  EXPECT_FALSE(closed(kNow_ns));
  interlock.write({0, true}, kNow_ns);
  EXPECT_TRUE(closed(kNow_ns));
  EXPECT_FALSE(closed(kNow_ns + 20'000'000)) << "its process stands still";
  panel.set({.relay_closed = true, .relay_wired = true});
  EXPECT_TRUE(closed(kNow_ns + 20'000'000));
}

// Reported: the process that stands for a relay also runs beside a device that has one, and hid that it was
// open.
TEST_F(RelaysContact, IsThatOfTheWireAloneWhereThereIsOne) {
  for (const bool process : {true, false})
    for (const bool contact : {true, false}) {
      interlock.write({0, process}, kNow_ns);
      panel.set({.relay_closed = contact, .relay_wired = true});
      EXPECT_EQ(closed(kNow_ns), contact);
      panel.set({.relay_closed = contact, .relay_wired = false});
      EXPECT_EQ(closed(kNow_ns), process) << "there is no such contact";
    }
}

TEST_F(SharedIoFile, AreDrivenByOneProcessEach) {
  std::optional<StageIo> stage(folder_.path());
  const SupervisorIo supervisor(folder_.path());
  EXPECT_EQ(refusal([&] { const StageIo second(folder_.path()); }), "another process owns this file");
  stage.reset();
  EXPECT_EQ(refusal([&] { const StageIo second(folder_.path()); }), "");
}

TEST_F(SharedIoFile, AreNotMadeAnewUnderARunningRobot) {
  std::optional<InterlockIo> interlock(folder_.path());
  EXPECT_EQ(refusal([&] { create_shared_io(folder_.path()); }), "belongs to a robot that is running");
  interlock.reset();
  EXPECT_EQ(refusal([&] { create_shared_io(folder_.path()); }), "");
}

TEST_F(SharedIoFile, ReadersOfOldLinesSeeNothingOfNewOnes) {
  const IoReader old(folder_.path());
  create_shared_io(folder_.path());
  StageIo stage(folder_.path());
  stage.pulse();
  EXPECT_EQ(old.stage_pulses(), 0U);
  EXPECT_EQ(IoReader(folder_.path()).stage_pulses(), 1U);
}

TEST_F(SharedIoFile, OfAnotherOwnerCannotBeWrittenEvenByMistake) {
  const OwnOutputs<SupervisorOutputs> own(folder_.path());
  own->pulses = 1;
  const SeenOutputs<StageOutputs> stage(folder_.path());
  const SeenOutputs<InterlockOutputs> interlock(folder_.path());
  EXPECT_DEATH(const_cast<Word&>(stage->pulses) = 1, "");
  EXPECT_DEATH(const_cast<Word&>(interlock->load) = 1, "");
}

TEST_F(SharedIoFile, MayBeReadByAGroup) {
  ::chmod(file().c_str(), 0640);
  EXPECT_EQ(refusal_to_attach(folder_.path()), "");
}

TEST_F(SharedIoFile, OfOneOwnerIsNotTakenForThatOfAnother) {
  std::filesystem::copy_file(folder_ / "panel", file(), std::filesystem::copy_options::overwrite_existing);
  ::chmod(file().c_str(), 0600);
  EXPECT_EQ(refusal_to_attach(folder_.path()), "is the file of another owner");
}

TEST_F(SharedIoFile, AreRefusedWhenMissingOrAccessibleToOthers) {
  const ScratchFolder empty;
  EXPECT_NE(refusal_to_attach(empty.path()), "");
  EXPECT_NE(refusal([&] { create_shared_io(empty / "nowhere"); }), "");
  for (const mode_t open : {0660, 0650, 0604, 0602, 0601}) {
    ::chmod(file().c_str(), open);
    EXPECT_EQ(refusal_to_attach(folder_.path()), "is accessible to other users");
  }
  ::chmod(file().c_str(), 0600);
  std::filesystem::rename(file(), folder_ / "elsewhere");
  std::filesystem::create_symlink(folder_ / "elsewhere", file());
  EXPECT_NE(refusal_to_attach(folder_.path()), "") << "a link may lead anywhere";
  std::filesystem::remove(file());
  std::filesystem::create_directory(file());
  EXPECT_NE(refusal_to_attach(folder_.path()), "");
}

TEST_F(SharedIoFile, AreRefusedWithAWrongBitInTheHeaderOrAnotherLength) {
  const std::string sound = file_content(file());
  for (std::size_t bit = 0; bit < 16 * 8; ++bit) {
    std::string corrupt = sound;
    corrupt[bit / 8] = static_cast<char>(corrupt[bit / 8] ^ 1 << bit % 8);
    write_content(file(), corrupt);
    EXPECT_NE(refusal_to_attach(folder_.path()), "") << "bit " << bit;
  }
  std::mt19937 random(6);
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = std::uniform_int_distribution<std::size_t>(0, 2 * sound.size())(random);
    if (size == sound.size()) continue;
    std::string other = sound;
    other.resize(size);
    write_content(file(), other);
    EXPECT_NE(refusal_to_attach(folder_.path()), "") << size << " bytes";
  }
  write_content(file(), sound);
  EXPECT_EQ(refusal_to_attach(folder_.path()), "");
}

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

std::string refusal_of(const auto& act) {
  try {
    act();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SharedIoRefusals, SayTheSystemsReasonAndLeaveNothingOpenOrBehind) {
  const ScratchFolder folder;
  const std::ptrdiff_t files = open_files();
  const auto missing = folder.path() / "none";
  EXPECT_NE(refusal_of([&] { create_shared_io(missing); }).find("No such file"), std::string::npos);
  EXPECT_NE(refusal_of([&] { IoFile(missing, Owner::Stage, IoFile::Access::Own); }).find("No such file"),
            std::string::npos);
  std::filesystem::create_directories(folder.path() / "stage" / "taken");
  EXPECT_NE(refusal_of([&] { create_shared_io(folder.path()); }).find("cannot be made"), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
      << "a temporary file stays behind";
  std::filesystem::remove_all(folder.path() / "stage");
  create_shared_io(folder.path());
  for (const auto others : {std::filesystem::perms::others_exec, std::filesystem::perms::group_write}) {
    std::filesystem::permissions(folder.path() / "stage", std::filesystem::perms::owner_read |
                                                              std::filesystem::perms::owner_write | others);
    EXPECT_NE(refusal_of([&] {
                IoFile(folder.path(), Owner::Stage, IoFile::Access::Own);
              }).find("accessible to other users"),
              std::string::npos);
  }
  EXPECT_EQ(open_files(), files);
}

TEST(SharedIoRefusals, AnOwnerKeepsItsFileOpenAndClosesItAtItsEnd) {
  const ScratchFolder folder;
  create_shared_io(folder.path());
  const std::ptrdiff_t files = open_files();
  {
    const IoFile owner(folder.path(), Owner::Stage, IoFile::Access::Own);
    EXPECT_EQ(open_files(), files + 1);
    EXPECT_NE(refusal_of([&] { IoFile(folder.path(), Owner::Stage, IoFile::Access::Own); }), "accepted");
  }
  EXPECT_EQ(open_files(), files);
  EXPECT_EQ(refusal_of([&] { IoFile(folder.path(), Owner::Stage, IoFile::Access::Own); }), "accepted");
}

// A limit of this process, lowered for a test.
class LowerLimit {
 public:
  LowerLimit(__rlimit_resource resource, rlim_t limit) : resource_(resource) {
    ::getrlimit(resource_, &before_);
    const rlimit lower{limit, before_.rlim_max};
    ::setrlimit(resource_, &lower);
  }
  ~LowerLimit() { ::setrlimit(resource_, &before_); }
  LowerLimit(const LowerLimit&) = delete;
  LowerLimit& operator=(const LowerLimit&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

// As on a disk that has space for the title of the file only.
TEST(SharedIoRefusals, AreMadeWholeOrNotAtAll) {
  const ScratchFolder folder;
  const auto signal_before = ::signal(SIGXFSZ, SIG_IGN);
  const std::string refused = [&] {
    const LowerLimit size(RLIMIT_FSIZE, kFileSize / 2);
    return refusal_of([&] { create_shared_io(folder.path()); });
  }();
  ::signal(SIGXFSZ, signal_before);
  EXPECT_NE(refused.find("cannot be made: File too large"), std::string::npos) << refused;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

#ifndef __SANITIZE_ADDRESS__  // which needs address space itself
TEST(SharedIoRefusals, WithoutMemoryToMapIntoAreAnError) {
  const ScratchFolder folder;
  create_shared_io(folder.path());
  const std::ptrdiff_t files = open_files();
  const std::string refused = [&] {
    const LowerLimit memory(RLIMIT_AS, 1);
    return refusal_of([&] { IoFile(folder.path(), Owner::Stage, IoFile::Access::Own); });
  }();
  EXPECT_NE(refused.find("cannot be mapped"), std::string::npos) << refused;
  EXPECT_EQ(open_files(), files);
}
#endif

// A service that was started without standard input gets descriptor 0 for its first file.
TEST(SharedIoRefusals, DescriptorZeroIsAFileLikeAnyOther) {
  const ScratchFolder folder;
  create_shared_io(folder.path());
  const int input = ::dup(0);
  ::close(0);
  {
    const IoFile owner(folder.path(), Owner::Stage, IoFile::Access::Own);
    EXPECT_NE(::fcntl(0, F_GETFD), -1);
    EXPECT_NE(::fcntl(1, F_GETFD), -1) << "and no other is closed";
    EXPECT_EQ(refusal_of([&] { IoFile(folder.path(), Owner::Panel, IoFile::Access::Own); }), "accepted");
  }
  EXPECT_EQ(::fcntl(0, F_GETFD), -1) << "closed at the end";
  write_content(folder.path() / "stage", "short");
  EXPECT_NE(refusal_of([&] { IoFile(folder.path(), Owner::Stage, IoFile::Access::Own); }), "accepted");
  EXPECT_EQ(::fcntl(0, F_GETFD), -1) << "closed when it is refused";
  ::dup2(input, 0);
  ::close(input);
}

}  // namespace
}  // namespace biopsy::digital_io
