// Published measurements: the electro-mechanical positioning system of Janot, Gautier and Brunot (2019), a
// carriage on a guide with known Coulomb friction and a known offset of its drive.
#include <fmt/format.h>

#include <cmath>

#include "tests/robot/cli/command.hpp"

namespace biopsy::cli_tests {
namespace {

namespace fs = std::filesystem;

const fs::path kEmps = kShared / "gap/emps";

// Columns motor_force_N and q_meas_m of the published file, in the columns of a data set.
std::string as_run(const fs::path& recorded) {
  std::ifstream stream(recorded);
  std::string line, out = "time_s,force_N,displacement_mm\n";
  std::getline(stream, line);
  EXPECT_TRUE(line.starts_with("t_s,motor_voltage_V,motor_force_N,q_meas_m")) << line;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    std::string time, volts, force, metres;
    std::getline(cells, time, ',');
    std::getline(cells, volts, ',');
    std::getline(cells, force, ',');
    std::getline(cells, metres, ',');
    out += fmt::format("{},{},{}\n", time, force, std::stod(metres) * 1e3);
  }
  return out;
}

// The published file as it is, the model a guess, and no option.
TEST(GapOnPublicData, NamesTheFrictionOfEmpsWithoutBeingTold) {
  if (!fs::exists(kEmps)) GTEST_SKIP() << "needs the public data set at " << kEmps;
  const ScratchFolder folder;
  std::string list =
      "title = \"EMPS\"\n[columns]\ntime = \"t_s\"\nforce = \"motor_force_N\"\ndisplacement = { name = "
      "\"q_meas_m\", "
      "unit = \"m\" }\n";
  for (const char* run : {"emps_train", "emps_test_pulses"}) {
    fs::copy_file(kEmps / (run + std::string(".csv")), folder / (run + std::string(".csv")));
    list += fmt::format("\n[[run]]\nname = \"{0}\"\nfile = \"{0}.csv\"\nrole = \"{1}\"\n", run,
                        run == std::string("emps_train") ? "train" : "test");
  }
  folder.write("dataset.toml", list);
  folder.write("rig.toml", "[baseline]\ndrive = \"force\"\nm = 80\nc_s = 150\nk = 0\n");
  const Outcome answer = biopsy("gap " + folder.path().string() + " --model " +
                                (folder / "rig.toml").string() + " --out " + (folder / "out").string());
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json found = json_of(folder / "out/gap.json");
  ASSERT_EQ(found["verdict"], "effect") << answer.text;
  EXPECT_EQ(found["effects"][0]["name"], "coulomb_friction");
  EXPECT_NEAR(found["effects"][0]["parameters"]["force_N"]["value"], 20.39, 0.12 * 20.39);  // published
  EXPECT_EQ(found["comparison"]["window_s"], 0.5);
  EXPECT_EQ(found["comparison"]["free"], (std::vector<std::string>{"m", "c_s"}));
  EXPECT_EQ(found["comparison"]["set_up"], "bench");
  EXPECT_TRUE(found["data"].empty()) << found["data"];
}

TEST(GapOnPublicData, FindsTheFrictionAndTheOffsetOfEmps) {
  if (!fs::exists(kEmps)) GTEST_SKIP() << "needs the public data set at " << kEmps;
  const ScratchFolder folder;
  std::string list = "title = \"EMPS\"\n";
  for (const char* run : {"emps_train", "emps_test_pulses"}) {
    folder.write(run + std::string(".csv"), as_run(kEmps / (run + std::string(".csv"))));
    list += fmt::format("\n[[run]]\nname = \"{0}\"\nfile = \"{0}.csv\"\n", run);
  }
  folder.write("dataset.toml", list);
  folder.write("rig.toml", "[baseline]\ndrive = \"force\"\nm = 80\nc_s = 150\nk = 0\n");
  const Outcome answer =
      biopsy("gap " + folder.path().string() + " --model " + (folder / "rig.toml").string() +
             " --free m,c_s --window 0.5 --out " + (folder / "out").string());
  ASSERT_EQ(answer.code, 0) << answer.text;
  const nlohmann::json found = json_of(folder / "out/gap.json");
  ASSERT_EQ(found["verdict"], "effect") << answer.text;
  ASSERT_GE(found["effects"].size(), 2U) << answer.text;
  const auto& effects = found["effects"];
  EXPECT_EQ(effects[0]["name"], "coulomb_friction");
  EXPECT_EQ(effects[1]["name"], "external_force");
  const auto near = [](double value, double published, double share) {
    EXPECT_NEAR(value, published, share * std::abs(published));
  };
  // Published: mass 95.1089 kg, viscous 203.5034 N s/m, Coulomb 20.3935 N, offset -3.1648 N.
  near(effects[0]["parameters"].value("force_N", nlohmann::json::object()).value("value", 0.0), 20.39, 0.10);
  near(effects[1]["parameters"].value("force_N", nlohmann::json::object()).value("value", 0.0), -3.16, 0.15);
  for (const auto& p : found["parameters_changed"]) {
    if (p["name"] == "m") near(p["after"], 95.1, 0.10);
    if (p["name"] == "c_s") near(p["after"], 203.5, 0.10);
  }
  EXPECT_EQ(found["parameters_changed"].size(), 2U) << found["parameters_changed"];
  EXPECT_LE(found["rmse_mm"]["after"], 0.79);  // 0.72 within 10 %
  EXPECT_TRUE(found["margins"].empty()) << "a rig that is no needle stage rehearses no biopsy";
}

}  // namespace
}  // namespace biopsy::cli_tests
