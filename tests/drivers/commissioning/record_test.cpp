// A commissioning record is accepted for its device and configuration for a year; anything else is refused.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>
#include <random>
#include <string>

#include "drivers/commissioning/load_commissioning.hpp"
#include "drivers/commissioning/steps.hpp"
#include "robot/common/ed25519.hpp"
#include "robot/common/sha256.hpp"
#include "robot/common/text/encoding.hpp"
#include "tests/key_files.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sim/plant/refusal.hpp"

namespace biopsy::commissioning {
namespace {

namespace fs = std::filesystem;
using std::chrono::days;
using std::chrono::hours;
using Moment = std::chrono::system_clock::time_point;

const Device kDevice{"nidaqmx", "USB-6211", 30123456};
const Moment kMade = std::chrono::sys_days{std::chrono::year{2026} / 11 / 21} + hours(9);

// Every step done, every figure in the middle of its limits.
Record sound_record() {
  Record record{kDevice, hex(sha256("configuration")), "biopsy 0.1.0", 0, {}};
  record.made_unix_s = std::chrono::duration_cast<std::chrono::seconds>(kMade.time_since_epoch()).count();
  for (const Step& step : all_steps()) {
    StepRecord done{std::string(step.name), {}, "by hand"};
    for (const Limit& limit : step.limits)
      done.figures.push_back({std::string(limit.what), std::string(limit.unit), (limit.low + limit.high) / 2,
                              limit.low, limit.high, std::string(limit.why)});
    record.steps.push_back(done);
  }
  return record;
}

class CommissioningRecord : public testing::Test {
 protected:
  void SetUp() override {
    make_key_files(folder_ / "key.pem", folder_ / "key.pub.pem");
    store(to_json(sound_record()));
  }
  void store(const std::string& text, const std::string& key = "key.pem") const {
    write_content(folder_ / kRecordFile, text);
    write_content(folder_ / kSignatureFile, std::string(view(SigningKey(folder_ / key).sign(text))));
  }
  Record load(Moment now = kMade + days(30), const Device& device = kDevice,
              const std::string& config = "configuration") const {
    return load_commissioning(folder_.path(), folder_ / "key.pub.pem", device, hex(sha256(config)), now);
  }
  std::string refusal(Moment now = kMade + days(30), const Device& device = kDevice,
                      const std::string& config = "configuration") const {
    return sim::refusal([&] { load(now, device, config); });
  }
  void expect_refusal(const std::string& text, const std::string& reason) const {
    sim::expect_refusal(text, folder_.path().string(), reason);
  }

  ScratchFolder folder_;
};

TEST_F(CommissioningRecord, IsAcceptedForItsDeviceAndConfigurationForAYear) {
  EXPECT_EQ(refusal(kMade), "accepted");
  EXPECT_EQ(refusal(kMade + days(365)), "accepted");
  EXPECT_EQ(to_json(load()), to_json(sound_record()));
}

TEST_F(CommissioningRecord, OlderThanAYearOrOfADayToComeIsRefused) {
  expect_refusal(refusal(kMade + days(365) + hours(1)), "older than 365 days");
  expect_refusal(refusal(kMade - days(1)), "dated in the future");
}

TEST_F(CommissioningRecord, OfAnotherDeviceOrConfigurationIsRefused) {
  Device other = kDevice;
  other.serial = 7;
  expect_refusal(refusal(kMade, other), "connected is nidaqmx USB-6211 7");
  other = kDevice;
  other.kind = "sim";
  expect_refusal(refusal(kMade, other), "is the record of nidaqmx USB-6211 30123456");
  expect_refusal(refusal(kMade, kDevice, "Configuration"), "configuration was changed");
}

TEST_F(CommissioningRecord, MissingRecordOrSignatureIsRefused) {
  fs::remove(folder_ / kSignatureFile);
  expect_refusal(refusal(), "no record of commissioning");
  fs::remove(folder_ / kRecordFile);
  expect_refusal(refusal(), "no record of commissioning");
}

TEST_F(CommissioningRecord, EveryFlippedBitOfRecordOrSignatureIsRefused) {
  const std::string text = file_content(folder_ / kRecordFile),
                    signature = file_content(folder_ / kSignatureFile);
  ASSERT_EQ(signature.size(), 64U);
  std::mt19937_64 random(1);
  for (int k = 0; k < 100; ++k) {
    std::string changed = k % 2 == 0 ? text : signature;
    changed[random() % changed.size()] ^= static_cast<char>(1U << (random() % 8));
    write_content(folder_ / (k % 2 == 0 ? kRecordFile : kSignatureFile), changed);
    expect_refusal(refusal(), "changed after it was signed");
    write_content(folder_ / (k % 2 == 0 ? kRecordFile : kSignatureFile), k % 2 == 0 ? text : signature);
  }
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(CommissioningRecord, SignedWithAnotherKeyIsRefused) {
  make_key_files(folder_ / "other.pem");
  store(to_json(sound_record()), "other.pem");
  expect_refusal(refusal(), "signed with another key");
}

TEST_F(CommissioningRecord, ThatDidNotPassIsRefusedThoughItIsSigned) {
  const auto refused_with = [&](const std::function<void(Record&)>& change) {
    Record record = sound_record();
    change(record);
    store(to_json(record));
    expect_refusal(refusal(), "did not pass all steps");
  };
  refused_with([](Record& r) { r.steps.back().figures.front().value = 1e6; });
  refused_with([](Record& r) { r.steps[1].figures[0].value = std::numeric_limits<double>::quiet_NaN(); });
  refused_with([](Record& r) { r.steps.pop_back(); });
  refused_with([](Record& r) { r.steps.clear(); });
  refused_with([](Record& r) { std::swap(r.steps[0], r.steps[1]); });
  refused_with([](Record& r) { r.steps[2].figures.pop_back(); });
}

TEST_F(CommissioningRecord, WhateverIsWrittenIsARecordOrASetupError) {
  const std::string text = to_json(sound_record());
  std::mt19937_64 random(2);
  const std::vector<std::string> words{
      "null", "-1", "1e999", "\"\"", "{}", "[]", "true", "99999999999999999999", ","};
  int read = 0, refused = 0;
  for (int k = 0; k < 2'000; ++k) {
    std::string changed = text;
    const std::size_t at = random() % changed.size();
    if (random() % 3 == 0) changed[at] = static_cast<char>(random() % 256);
    if (random() % 3 == 0) changed.erase(at, random() % 50);
    const std::size_t colon = changed.find(": ", at);
    if (random() % 2 == 0 && colon != std::string::npos)
      changed.replace(colon + 2, changed.find_first_of(",\n", colon) - colon - 2,
                      words[random() % words.size()]);
    try {
      EXPECT_FALSE(to_json(from_json(changed, "record")).empty());
      ++read;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.where, "record");
      ++refused;
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace biopsy::commissioning
