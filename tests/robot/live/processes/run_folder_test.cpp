// The run folder of a live robot: what stands in the settings, and what is refused before anything is
// started. The keys are real ones.
#include <sys/stat.h>

#include "robot/security/check_keys.hpp"
#include "tests/robot/live/processes/session_bench.hpp"

namespace biopsy::robot {
namespace {

struct RunFolder : SessionBench {
  RunFolder() { make_keys(folder / "keys"); }
};

TEST_F(RunFolder, HoldsTheSettingsOfARehearsal) {
  options.network = "eth7";
  options.fifo_priority = 42;
  options.faults = folder / "faults.toml";
  const live::LiveSettings settings = write();
  EXPECT_EQ(settings.domain, options.domain);
  EXPECT_EQ(settings.robot, 1U);
  EXPECT_EQ(settings.keys, folder / "keys");
  EXPECT_EQ(settings.network, "eth7");
  EXPECT_EQ(settings.device, "sim");
  EXPECT_EQ(settings.device_config, "") << "of a real stage only";
  EXPECT_EQ(settings.commissioning, "");
  EXPECT_EQ(settings.commissioning_key, "");
  EXPECT_EQ(settings.log, folder / "run/procedure.log.sqlite");
  EXPECT_EQ(settings.log_key, folder / "keys/recorder/signing_key.pem");
  EXPECT_EQ(settings.lines, lines());
  EXPECT_EQ(settings.fifo_priority, 42);
  EXPECT_EQ(settings.model, folder / "model.toml");
  EXPECT_EQ(settings.tissues, folder / "tissues.toml");
  EXPECT_EQ(settings.faults, folder / "faults.toml");
  EXPECT_EQ(settings.weight_g, 31.0);
  EXPECT_EQ(settings.seed, 17U);
  ASSERT_EQ(settings.layers.size(), 1U);
  EXPECT_EQ(settings.layers[0].name, "skin");
  EXPECT_EQ(file_content(folder / "run/live.json"), live::to_json(settings));
}

TEST_F(RunFolder, NamesEveryFileByItsWholePathWhereverItIsStartedFrom) {
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  options.keys = "keys", options.faults = "faults.toml";
  prepared.given.rehearsal.model = "model.toml", prepared.given.rehearsal.tissues = "tissues.toml";
  hardware = {"board.toml", "commissioned"};
  const live::LiveSettings simulated = write_run_folder(options, "sim", hardware, prepared, "run");
  const live::LiveSettings real = write_run_folder(options, "nidaqmx", hardware, prepared, "run");
  options.separate_users = true;
  const live::LiveSettings apart = write_run_folder(options, "nidaqmx", hardware, prepared, "run");
  fs::current_path(before);
  for (const fs::path& path : {simulated.keys, simulated.log, simulated.log_key, simulated.model,
                               simulated.tissues, simulated.faults, real.device_config, real.commissioning,
                               real.commissioning_key, apart.commissioning_key})
    EXPECT_TRUE(path.is_absolute()) << path;
}

TEST_F(RunFolder, NamesNoFaultsAndNoKeysWhereThereAreNone) {
  options.without_security = true;
  const live::LiveSettings settings = write();
  EXPECT_EQ(settings.faults, "");
  EXPECT_EQ(settings.keys, "");
  EXPECT_EQ(settings.log_key, folder / "keys/recorder/signing_key.pem") << "the log is signed all the same";
}

TEST_F(RunFolder, OfARealStageNamesItsBoardAndItsCommissioning) {
  const live::LiveSettings settings = write("nidaqmx");
  EXPECT_EQ(settings.device, "nidaqmx");
  EXPECT_EQ(settings.device_config, folder / "board.toml");
  EXPECT_EQ(settings.commissioning, folder / "commissioned");
  EXPECT_EQ(settings.commissioning_key, folder / "keys/commissioning/signing_public.pem");
  EXPECT_FALSE(fs::exists(folder / "run/signing_public.pem"));
}

// The stage's user may not pass the folder of the keys.
TEST_F(RunFolder, WithAUserForEachProcessHoldsACopyOfTheCommissioningKeyAndTheLogIsTheRecorders) {
  options.separate_users = true;
  EXPECT_EQ(write().log, "procedure.log.sqlite");
  EXPECT_EQ(write().commissioning_key, "");
  const live::LiveSettings settings = write("nidaqmx");
  EXPECT_EQ(settings.commissioning_key, folder / "run/signing_public.pem");
  EXPECT_EQ(file_content(settings.commissioning_key),
            file_content(folder / "keys/commissioning/signing_public.pem"));
  EXPECT_EQ(file_content(folder / "run/live.json"), live::to_json(settings));
}

TEST_F(RunFolder, ARealStageIsRefusedWithoutItsFilesOrWithoutSecurity) {
  const HardwareOptions whole = hardware;
  for (const HardwareOptions& part :
       std::initializer_list<HardwareOptions>{{}, {whole.config, ""}, {"", whole.commissioning}}) {
    hardware = part;
    EXPECT_EQ(what([&] { write("nidaqmx"); }),
              "a real stage without --device-config or --commissioning | command line");
    EXPECT_NO_THROW(write("sim"));
  }
  hardware = whole;
  options.without_security = true;
  EXPECT_EQ(what([&] { write("nidaqmx"); }), "--without-security with a real stage | command line");
}

TEST_F(RunFolder, RefusesKeysThatAProcessCouldNotUse) {
  for (const char* role : {"stage", "controller", "supervisor", "recorder", "planner"}) {
    const fs::path own = folder / "keys" / role;
    fs::rename(own, own.string() + ".away");
    EXPECT_NE(what([&] { write(); }).find("is missing"), std::string::npos) << role;
    EXPECT_FALSE(fs::exists(folder / "run/live.json")) << "nothing was written yet";
    fs::rename(own.string() + ".away", own);
  }
}

TEST_F(RunFolder, HoldsTheDigitalIoInMemoryForThisUserAlone) {
  write();
  EXPECT_EQ(fs::status(lines()).permissions(), fs::perms::owner_all);
  EXPECT_NO_THROW(digital_io::IoReader{lines()});
  fs::permissions(lines(), fs::perms::all);
  write();
  EXPECT_EQ(fs::status(lines()).permissions(), fs::perms::owner_all) << "of an earlier start";
}

// The folder for it may be written by everybody.
TEST_F(RunFolder, TakesNoFolderForTheDigitalIoThatSomebodyElsePutThere) {
  const auto is_refused = [&] {
    const std::string refusal = what([&] { write(); });
    return refusal.starts_with("the folder cannot be made: File exists") ||
           refusal.starts_with("the folder cannot be made: Operation not permitted");
  };
  write_content(lines(), "in the way");
  EXPECT_TRUE(is_refused()) << "a file";
  fs::remove(lines());
  fs::create_directories(folder / "elsewhere");
  fs::permissions(folder / "elsewhere", fs::perms::all);
  fs::create_directory_symlink(folder / "elsewhere", lines());
  EXPECT_TRUE(is_refused()) << "a link";
  EXPECT_EQ(fs::status(folder / "elsewhere").permissions(), fs::perms::all)
      << "what it leads to is untouched";
  EXPECT_TRUE(fs::is_empty(folder / "elsewhere"));
  fs::remove(lines());
  fs::create_directory(lines());
  system.user = ::getuid() + 1;
  fs::rename(fmt::format("/dev/shm/biopsy-{}-{}-1", *system.user - 1, options.domain), lines());
  EXPECT_TRUE(is_refused()) << "one of a user with a smaller number";
  EXPECT_TRUE(fs::is_empty(lines()));
  fs::remove(lines());
  system.user.reset();
  if (::geteuid() != 0) return;  // only root can make one of somebody else
  fs::create_directory(lines());
  ASSERT_EQ(::chown(lines().c_str(), 1, 0), 0);
  EXPECT_TRUE(is_refused());
  EXPECT_TRUE(fs::is_empty(lines()));
}

TEST_F(SessionBench, ARehearsalWithoutKeysMakesThemOnceAndARealStageUsesThoseOfTheUser) {
  options.keys.clear();
  EXPECT_EQ(write().keys, folder / "run/keys");
  const std::string made = file_content(folder / "run/keys/recorder/signing_key.pem");
  EXPECT_FALSE(made.empty());
  EXPECT_EQ(write().log_key, folder / "run/keys/recorder/signing_key.pem");
  EXPECT_EQ(file_content(folder / "run/keys/recorder/signing_key.pem"), made) << "the log goes on";
  const auto in_a_year =
      std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) + std::chrono::days(365);
  const auto check_at = [&](std::chrono::sys_seconds time) {
    security::check_keys(folder / "run/keys", security::Role::Stage, time);
  };
  EXPECT_NO_THROW(check_at(in_a_year - std::chrono::hours(1)));
  EXPECT_THROW(check_at(in_a_year + std::chrono::hours(1)), ConfigError);
  EXPECT_NE(what([&] { write("nidaqmx"); }).find((folder / "config/biopsy/keys").string()),
            std::string::npos);
}

}  // namespace
}  // namespace biopsy::robot
