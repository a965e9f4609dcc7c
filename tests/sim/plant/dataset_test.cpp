// Data sets: what is accepted, and what is refused with file, line and column.
#include "sim/plant/dataset.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/scratch_folder.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::sim {
namespace {

constexpr const char* kToml = "title = \"t\"\n[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = 50\n";
constexpr const char* kCsv = "time_s,voltage_V,displacement_mm\n0.000,0,0\n0.001,100,0.1\n0.002,-200,0.2\n";

struct DatasetFolder : testing::Test {
  ScratchFolder folder;

  Dataset read(const std::string& csv, Drive drive = Drive::Stack, const std::string& toml = kToml) {
    folder.write("dataset.toml", toml);
    folder.write("a.csv", csv);
    return read_dataset(folder.path(), drive);
  }
  std::string csv_at(int line) const {
    return fmt::format("{}:{}", (folder.path() / "a.csv").string(), line);
  }
  void expect_refused(const std::string& csv, const std::string& place, const std::string& reason) {
    expect_refusal(refusal([&] { read(csv); }), place, reason);
  }
};

TEST_F(DatasetFolder, ComesInSiUnits) {
  const Dataset dataset = read(
      "time_s,voltage_V,displacement_mm,plate_b_mm,current_uA,external_force_N\n0,0,0,0,0,0.1\n0.001,1000,1."
      "5,2,3,0.2\n",
      Drive::Stack, std::string(kToml) + "external_force_N = 0.5\n");
  ASSERT_EQ(dataset.runs.size(), 1U);
  const RecordedRun& run = dataset.runs[0];
  EXPECT_EQ(dataset.title, "t");
  EXPECT_FALSE(dataset.sensor_noise.has_value());
  EXPECT_EQ(run.name, "a");
  EXPECT_DOUBLE_EQ(run.weight, 0.050);
  EXPECT_DOUBLE_EQ(run.period, 0.001);
  EXPECT_DOUBLE_EQ(run.input[1], 1000.0);
  EXPECT_DOUBLE_EQ(run.displacement[1], 1.5e-3);
  EXPECT_DOUBLE_EQ(run.plate_b[1], 2e-3);
  EXPECT_DOUBLE_EQ(run.current[1], 3e-6);
  EXPECT_DOUBLE_EQ(run.external_force[0], 0.6);  // column and constant add up
  EXPECT_DOUBLE_EQ(run.external_force[1], 0.7);
}

TEST_F(DatasetFolder, CommentsBlankLinesSpacesCrLfAndAnyOrderOfColumnsAreFine) {
  const RecordedRun run = read(
                              "# bench 3\r\n\r\n displacement_mm , time_s,voltage_V\r\n0.5,0,1\r\n# "
                              "pause\r\n 0.6 , 0.001 , 2\r\n")
                              .runs[0];
  EXPECT_EQ(run.time, (std::vector<double>{0.0, 0.001}));
  EXPECT_EQ(run.input, (std::vector<double>{1.0, 2.0}));
  EXPECT_DOUBLE_EQ(run.displacement[1], 0.6e-3);
}

TEST_F(DatasetFolder, AdditionalColumnsAreIgnored) {
  EXPECT_EQ(
      read("time_s,voltage_V,displacement_mm,temperature_degC\n0,0,0,21\n0.001,0,0,21\n").runs[0].time.size(),
      2U);
}

TEST_F(DatasetFolder, ForceDrivenRunsHaveAForceColumnInstead) {
  const std::string csv = "time_s,force_N,displacement_mm\n0,0.5,0\n0.001,0.6,0.1\n";
  EXPECT_EQ(read(csv, Drive::Force).runs[0].input, (std::vector<double>{0.5, 0.6}));
  expect_refusal(refusal([&] { read(csv, Drive::Stack); }), csv_at(1), "column `voltage_V` is missing");
  expect_refusal(refusal([&] { read(kCsv, Drive::Force); }), csv_at(1), "column `force_N` is missing");
}

TEST_F(DatasetFolder, EveryRateFromTwentyHertzToAHundredKilohertzIsTaken) {
  for (const double rate : {20.0, 44.1, 333.0, 1000.0, 48000.0, 96000.0, 100000.0}) {
    std::string csv = "time_s,voltage_V,displacement_mm\n";
    for (int k = 0; k < 50; ++k) csv += fmt::format("{:.6f},1,1\n", 3.0 + k / rate);
    EXPECT_NEAR(read(csv).runs[0].period, 1 / rate, 0.01 / rate) << rate;
  }
  for (const double rate : {10.0, 19.0, 110000.0, 1e6}) {
    std::string csv = "time_s,voltage_V,displacement_mm\n";
    for (int k = 0; k < 50; ++k) csv += fmt::format("{:.9f},1,1\n", k / rate);
    expect_refused(csv, (folder.path() / "a.csv").string(), "sampled every");
  }
}

TEST_F(DatasetFolder, RefusesMissingColumns) {
  expect_refused("time_s,voltage_V\n0,0\n0.001,0\n", csv_at(1), "column `displacement_mm` is missing");
  expect_refused("voltage_V,displacement_mm\n0,0\n0.001,0\n", csv_at(1), "column `time_s` is missing");
}

TEST_F(DatasetFolder, RefusesWrongUnitsInAHeader) {
  for (const std::string header : {"time_ms,voltage_V,displacement_mm", "time_s,voltage_kV,displacement_mm",
                                   "time_s,voltage_V,displacement_m", "time_s,voltage_V,displacement_um"})
    expect_refused(header + "\n0,0,0\n0.001,0,0\n", csv_at(1), "has the wrong unit");
  expect_refused("time_s,voltage_V,displacement_mm,current_mA\n0,0,0,0\n0.001,0,0,0\n", csv_at(1),
                 "`current_mA`");
  expect_refused("time_s,voltage_V,displacement_mm,external_force_mN\n0,0,0,0\n0.001,0,0,0\n", csv_at(1),
                 "`external_force_mN`");
  expect_refused("time_s,voltage_V,displacement_mm,plate_b_m\n0,0,0,0\n0.001,0,0,0\n", csv_at(1),
                 "`plate_b_m`");
}

TEST_F(DatasetFolder, HeaderIsCountedByItsLineInTheFile) {
  expect_refused("# one\n# two\ntime_s,voltage_kV,displacement_mm\n0,0,0\n0.001,0,0\n", csv_at(3),
                 "`voltage_kV`");
  expect_refused("# one\n\ntime_s,voltage_V\n0,0\n0.001,0\n", csv_at(3), "`displacement_mm` is missing");
}

TEST_F(DatasetFolder, RefusesAGapAndTimeThatStandsOrGoesBack) {
  const std::string head = "time_s,voltage_V,displacement_mm\n0.000,0,0\n0.001,0,0\n0.002,0,0\n0.003,0,0\n";
  expect_refused(head + "0.007,0,0\n0.008,0,0\n0.009,0,0\n", csv_at(6),
                 "a step of 0.004 s where the others take 0.001 s");
  expect_refused(head + "0.003,0,0\n", csv_at(6), "column `time_s`");
  expect_refused(head + "0.0025,0,0\n", csv_at(6), "time does not go on");
}

TEST_F(DatasetFolder, NamesTheLineOfTheGapNotTheFirstRow) {
  std::string csv = "time_s,voltage_V,displacement_mm\n";
  for (int k = 0; k < 1000; ++k) csv += fmt::format("{:.3f},0,0\n", (k < 500 ? k : k + 400) * 1e-3);
  expect_refused(csv, csv_at(502), "`time_s`");  // rows begin on line 2; row 500 comes after the gap
}

TEST_F(DatasetFolder, RefusesCellsThatAreNoNumbers) {
  for (const std::string cell :
       {"nan", "NaN", "inf", "-inf", "", "1,5", "1.5mm", "abc", "0x10", "1e999", "--1"})
    expect_refused("time_s,voltage_V,displacement_mm\n0,0,0\n0.001,0," + cell + "\n", csv_at(3), "");
  expect_refused("time_s,voltage_V,displacement_mm\n0,0,0\n0.001,nan,0\n", csv_at(3), "column `voltage_V`");
}

TEST_F(DatasetFolder, RefusesValuesBeyondAnySensor) {
  expect_refused("time_s,voltage_V,displacement_mm\n0,0,0\n0.001,30000,0\n", csv_at(3), "`voltage_V`");
}

TEST_F(DatasetFolder, RefusesRaggedRowsAndBadHeaders) {
  expect_refused("time_s,voltage_V,displacement_mm\n0,0\n", csv_at(2), "2 cells, but the header names 3");
  expect_refused("time_s,voltage_V,displacement_mm\n0,0,0,0\n", csv_at(2), "4 cells");
  expect_refused("time_s,voltage_V,displacement_mm,\n0,0,0,0\n", csv_at(1), "empty or there twice");
  expect_refused("time_s,time_s,voltage_V,displacement_mm\n0,0,0,0\n", csv_at(1), "empty or there twice");
}

TEST_F(DatasetFolder, RefusesFilesWithoutRows) {
  const std::string file = (folder.path() / "a.csv").string();
  expect_refused("", file, "holds no rows");
  expect_refused("time_s,voltage_V,displacement_mm\n", file, "holds no rows");
  expect_refused("# nothing\n", file, "holds no rows");
  expect_refused("time_s,voltage_V,displacement_mm\n0,0,0\n", file, "fewer than two rows");
}

TEST_F(DatasetFolder, RefusesFilesThatAreNotThereOrNotInTheFolder) {
  const auto with_file = [](const std::string& file) {
    return "[[run]]\nname = \"a\"\nfile = '" + file + "'\n";
  };
  const std::string toml = (folder.path() / "dataset.toml").string();
  expect_refusal(refusal([&] { read(kCsv, Drive::Stack, with_file("b.csv")); }),
                 (folder.path() / "b.csv").string(), "cannot be read");
  for (const std::string escape : {"../a.csv", "/etc/passwd", "sub/../a.csv", "./a.csv", ""})
    expect_refusal(refusal([&] { read(kCsv, Drive::Stack, with_file(escape)); }), toml + ":1",
                   "data set's folder");
  for (const std::string folder_name : {"..", "."})
    EXPECT_NE(refusal([&] { read(kCsv, Drive::Stack, with_file(folder_name)); }), "accepted") << folder_name;
}

TEST_F(DatasetFolder, RefusesADescriptionThatLacksSomething) {
  const std::string toml = (folder.path() / "dataset.toml").string();
  const auto text_of = [&](const std::string& text) {
    return refusal([&] { read(kCsv, Drive::Stack, text); });
  };
  expect_refusal(text_of("title = \"t\"\n"), toml, "no [[run]]");
  expect_refusal(text_of("[[run]]\nfile = \"a.csv\"\n"), toml + ":1", "`name` is missing");
  expect_refusal(text_of("[[run]]\nname = \"a\"\n"), toml + ":1", "`file` is missing");
  expect_refusal(text_of("[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = -5\n"), toml + ":4",
                 "`weight_g`");
  expect_refusal(text_of("[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_g = nan\n"), toml + ":4",
                 "`weight_g`");
  expect_refusal(text_of("sensor_noise_mm = -1\n"), toml + ":1", "`sensor_noise_mm`");
  expect_refusal(text_of("run = 3\n"), toml + ":1", "`run` is not a list of tables");
  expect_refusal(text_of("[[run]\n"), toml + ":1", "");
}

TEST_F(DatasetFolder, RefusesAWeightInAnotherUnit) {
  expect_refusal(refusal([&] {
                   read(kCsv, Drive::Stack, "[[run]]\nname = \"a\"\nfile = \"a.csv\"\nweight_kg = 0.05\n");
                 }),
                 (folder.path() / "dataset.toml").string() + ":4", "`weight_kg`");
}

// Files as a spreadsheet in a country with decimal commas writes them, and columns of another instrument.
TEST_F(DatasetFolder, SemicolonsDecimalCommasQuotesAndAByteOrderMarkAreUnderstood) {
  const RecordedRun run =
      read("\xEF\xBB\xBF\"time_s\";\"voltage_V\";\"displacement_mm\"\r\n0,000;0;0,5\r\n0,001;-1,5e3;0,75\r\n")
          .runs[0];
  EXPECT_EQ(run.input, (std::vector<double>{0.0, -1500.0}));
  EXPECT_DOUBLE_EQ(run.displacement[1], 0.75e-3);
  EXPECT_DOUBLE_EQ(
      read("time_s\tvoltage_V\tdisplacement_mm\n0\t0\t0,5\n0.001\t1\t1\n").runs[0].displacement[0], 0.5e-3);
  expect_refused("time_s;voltage_V;displacement_mm\n0;0;1.000,5\n0,001;0;0\n", csv_at(2),
                 "not a finite number");
  expect_refused(std::string("\xFF\xFEt\0", 4), (folder.path() / "a.csv").string(), "UTF-16");
}

TEST_F(DatasetFolder, ColumnsAreMappedWithUnitSignAndFactor) {
  const std::string columns =
      "[columns]\ntime = { name = \"t\", unit = \"ms\" }\nvoltage = { name = \"monitor\", unit = \"kV\" }\n"
      "displacement = { name = \"laser\", unit = \"um\", sign = -1, factor = 2 }\n[[run]]\nname = "
      "\"a\"\nfile = "
      "\"a.csv\"\n";
  const std::string csv = "t,monitor,laser,voltage_kV\n0,0,0,9\n1,1.5,-250,9\n";
  const RecordedRun run = read(csv, Drive::Stack, columns).runs[0];
  EXPECT_DOUBLE_EQ(run.period, 1e-3);
  EXPECT_DOUBLE_EQ(run.input[1], 1500.0);
  EXPECT_DOUBLE_EQ(run.displacement[1], 500e-6);
  // A run's own columns go before those of the data set.
  const RecordedRun own =
      read(csv, Drive::Stack, columns + "[run.columns]\ndisplacement = { name = \"laser\", unit = \"mm\" }\n")
          .runs[0];
  EXPECT_DOUBLE_EQ(own.displacement[1], -0.25);
}

TEST_F(DatasetFolder, RefusesUnknownKeysUnitsAndMissingMappedColumns) {
  const std::string toml = (folder.path() / "dataset.toml").string();
  const std::string run = "[[run]]\nname = \"a\"\nfile = \"a.csv\"\n";
  const auto text_of = [&](const std::string& text) {
    return refusal([&] { read(kCsv, Drive::Stack, text); });
  };
  expect_refusal(text_of(run + "weight = 0.05\n"), toml + ":4", "unknown name `weight`");
  expect_refusal(text_of("noise = 1\n" + run), toml + ":1", "unknown name `noise`");
  expect_refusal(text_of("[columns]\nlaser = \"x\"\n" + run), toml + ":2", "unknown name `laser`");
  expect_refusal(text_of("[columns]\ndisplacement = { units = \"um\" }\n" + run), toml + ":2",
                 "unknown name");
  expect_refusal(text_of("[columns]\ndisplacement = { unit = \"furlong\" }\n" + run), toml + ":2",
                 "is no unit of displacement");
  expect_refusal(text_of("[columns]\ndisplacement = { sign = 0.5 }\n" + run), toml + ":2",
                 "neither 1 nor -1");
  expect_refusal(text_of("[columns]\ndisplacement = \"laser\"\n" + run), csv_at(1),
                 "column `laser` is missing");
  expect_refusal(text_of("set_up = \"attic\"\n" + run), toml + ":1", "is unknown");
  expect_refusal(text_of(run + "role = \"exam\"\n"), toml + ":4", "is unknown");
  expect_refusal(text_of(run + "role = \"train\"\n"), toml, "the same for all");
}

TEST_F(DatasetFolder, TimeStampsThatScatterAreInterpolatedOnlyWhereItIsSaid) {
  std::string csv = "time_s,voltage_V,displacement_mm\n";
  for (int k = 0; k < 200; ++k) {
    const double t = 1e-3 * (k + 0.3 * std::sin(2.4 * k));
    if (k % 50 != 7) csv += fmt::format("{:.7f},{},{:.7f}\n", t, k / 10, std::sin(20.0 * t));
  }
  EXPECT_NE(refusal([&] { read(csv); }).find("are irregular"), std::string::npos);
  const RecordedRun run =
      read(csv, Drive::Stack, "resample = true\n" + std::string(kToml).substr(12)).runs[0];
  ASSERT_GT(run.time.size(), 180U);
  for (std::size_t i = 1; i + 1 < run.time.size(); ++i) {
    EXPECT_NEAR(run.time[i] - run.time[i - 1], run.period, 1e-12);
    EXPECT_NEAR(run.displacement[i], 1e-3 * std::sin(20.0 * run.time[i]), 1e-6);
    EXPECT_EQ(run.input[i], std::round(run.input[i])) << "inputs are held, not interpolated";
  }
}

TEST(Dataset, FolderWithoutADescriptionIsRefused) {
  const ScratchFolder folder;
  expect_refusal(refusal([&] { read_dataset(folder.path(), Drive::Stack); }), folder.path().string(),
                 "no dataset.toml");
}

TEST(Dataset, AFileInPlaceOfItsFolderIsRefused) {
  const ScratchFolder folder;
  const auto file = folder.path() / "dataset.toml";
  std::ofstream(file) << "title = \"x\"\n";
  expect_refusal(refusal([&] { read_dataset(file, Drive::Stack); }), file.string(),
                 "a file, where a folder is meant");
}

}  // namespace
}  // namespace biopsy::sim
