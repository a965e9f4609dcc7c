#include "robot/procedure/case/tip_calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "robot/common/config_error.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/files/data_folder.hpp"
#include "robot/common/files/file.hpp"
#include "robot/procedure/case/case.hpp"
#include "tests/key_files.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;

struct TipCalibrationFile : testing::Test {
  ScratchFolder folder;

  TipCalibrationFile() { make_key_files(folder / "key.pem", folder / "key.pub.pem"); }

  fs::path signed_file(const TipCalibration& calibration) const {
    const fs::path file = folder / "tip_calibration.toml";
    const std::string text = tip_calibration_toml(calibration);
    atomic_write(file, text);
    atomic_write(signature_of(file), std::string(view(SigningKey(folder / "key.pem").sign(text))));
    return file;
  }
};

TipCalibration of_titanium() {
  TipCalibration calibration;
  calibration.measurements = {{4.1, 0.2, "first"}, {4.5, 0.2, "second"}};
  calibration.offset = tip_offset_of("titanium 18 G", "GRE TE 5", calibration.measurements);
  return calibration;
}

TEST_F(TipCalibrationFile, IsReadAsItWasWrittenAndRefusedWhenChanged) {
  const TipCalibration written = of_titanium();
  const fs::path file = signed_file(written);
  const TipCalibration read = read_tip_calibration(file, folder / "key.pub.pem");
  EXPECT_EQ(read.offset.needle, "titanium 18 G");
  EXPECT_EQ(read.offset.sequence, "GRE TE 5");
  EXPECT_NEAR(read.offset.value.value, 4.3, 1e-3);
  EXPECT_EQ(read.measurements.size(), 2u);
  std::string text = read_file(file, "");
  text.replace(text.find("value_mm = 4.3"), 14, "value_mm = 0.3");
  atomic_write(file, text);
  EXPECT_THROW(read_tip_calibration(file, folder / "key.pub.pem"), ConfigError);
  fs::remove(signature_of(file));
  EXPECT_THROW(read_tip_calibration(file, folder / "key.pub.pem"), ConfigError);
}

TEST(TipOffset, IsKnownBetterAfterMoreInsertionsAndWorseWhereTheyScatter) {
  const auto sigma_of = [](const std::vector<TipMeasurement>& measurements) {
    return tip_offset_of("n", "s", measurements).sigma.value;
  };
  const TipMeasurement one{4.0, 0.15, ""};
  EXPECT_GT(sigma_of({one}), 0.3);
  EXPECT_LT(sigma_of({one, one, one, one, one}), sigma_of({one}));
  EXPECT_GT(sigma_of({{2.0, 0.15, ""}, {6.0, 0.15, ""}, {4.0, 0.15, ""}}), 1.0);
}

TEST(TipOffset, OfACaseIsThatOfThePaintedVoidUnlessItNamesANeedle) {
  const Case built_in = read_case("gap");
  ASSERT_TRUE(built_in.tip_offset);
  EXPECT_EQ(built_in.tip_offset->sequence, kSimulatedSequence);
}

TEST_F(TipCalibrationFile, OfACaseMustBeOfItsNeedleAndSequence) {
  TipCalibration simulated = of_titanium();
  simulated.offset.sequence = kSimulatedSequence;
  signed_file(simulated);
  const auto with = [&](const std::string& needle) {
    const fs::path file = folder / "case.toml";
    atomic_write(file, "[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 2.5\n" + needle);
    return read_case(file.string());
  };
  const std::string known = "[needle]\nname = \"titanium 18 G\"\nsequence = \"simulated\"\n";
  const std::string calibrated = "tip_calibration = \"tip_calibration.toml\"\n";
  EXPECT_NEAR(with(known + calibrated).tip_offset->value.value, 4.3, 1e-3);
  EXPECT_FALSE(with(known).tip_offset);
  EXPECT_THROW(with("[needle]\nname = \"glass\"\nsequence = \"simulated\"\n" + calibrated), ConfigError);
}

}  // namespace
}  // namespace biopsy::robot
