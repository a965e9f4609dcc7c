// Parts of a campaign as files. The runs are drawn, with doubles of any digits; damage is drawn too.
#include "robot/procedure/campaign/campaign_runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::robot {
namespace {

CampaignRuns drawn_campaign(unsigned seed, std::size_t entries, std::size_t each) {
  std::mt19937_64 dice(seed);
  std::normal_distribution<double> any(0.0, 3.0);
  CampaignRuns campaign{
      .identity = "abc", .target_mm = any(dice), .seed = 7, .images_accepted = seed % 2 == 0, .each = each};
  for (std::size_t e = 0; e < entries; ++e)
    campaign.names.push_back("fault \"" + std::to_string(e) + "\" \u00b5");
  for (std::size_t i = 0; i < entries * each; ++i) {
    CampaignRun run{.done = true, .began = dice() % 2 == 0, .completed = dice() % 3 == 0};
    run.beyond_mm = any(dice), run.off_mm = any(dice), run.from_depth_mm = any(dice) * 1e-17;
    if (dice() % 2 == 0)
      run.detected_by = "H-0" + std::to_string(dice() % 9), run.detected_after_ms = any(dice) / 3.0;
    campaign.runs.push_back(run);
  }
  return campaign;
}

void expect_same(const CampaignRuns& a, const CampaignRuns& b) {
  ASSERT_EQ(a.runs.size(), b.runs.size());
  EXPECT_EQ(a.identity, b.identity);
  EXPECT_EQ(a.target_mm, b.target_mm);
  EXPECT_EQ(a.seed, b.seed);
  EXPECT_EQ(a.images_accepted, b.images_accepted);
  EXPECT_EQ(a.names, b.names);
  for (std::size_t i = 0; i < a.runs.size(); ++i) {
    EXPECT_TRUE(b.runs[i].done);
    EXPECT_EQ(a.runs[i].began, b.runs[i].began);
    EXPECT_EQ(a.runs[i].completed, b.runs[i].completed);
    EXPECT_EQ(a.runs[i].beyond_mm, b.runs[i].beyond_mm);
    EXPECT_EQ(a.runs[i].off_mm, b.runs[i].off_mm);
    EXPECT_EQ(a.runs[i].from_depth_mm, b.runs[i].from_depth_mm);
    EXPECT_EQ(a.runs[i].detected_by, b.runs[i].detected_by);
    EXPECT_TRUE(a.runs[i].detected_after_ms == b.runs[i].detected_after_ms ||
                (std::isnan(a.runs[i].detected_after_ms) && std::isnan(b.runs[i].detected_after_ms)));
  }
}

void write_all(const std::filesystem::path& folder, const CampaignRuns& campaign, std::size_t count) {
  for (std::size_t index = 1; index <= count; ++index)
    write_shard(shard_file(folder, {index, count}), campaign, {index, count});
}

TEST(CampaignShards, MergedAreTheWholeToTheBit) {
  for (const std::size_t count : {1U, 2U, 3U, 7U, 40U}) {  // 40: more than there are runs
    const ScratchFolder folder;
    const CampaignRuns campaign = drawn_campaign(static_cast<unsigned>(count), 5, 7);
    write_all(folder / "shards", campaign, count);
    expect_same(campaign, merge_shards(folder / "shards", count));
  }
}

// A needle that overshot once and was left short of the target is as far from it as it was left.
TEST(CampaignShards, ACompletedRunIsOffByItsLastDepthAndNotByItsDeepest) {
  CampaignRuns campaign;
  campaign.names = {"fault"};
  campaign.each = 2;
  campaign.runs = {{.done = true, .completed = true, .beyond_mm = 0.1, .off_mm = -0.3},
                   {.done = true, .completed = false, .beyond_mm = 0.2, .off_mm = -2.0}};
  const EntryResult result = entry_results(campaign)[0];
  EXPECT_EQ(result.completed_off_mm, 0.3);
  EXPECT_EQ(result.worst_mm, 0.2);
}

TEST(CampaignShards, EveryRunIsInOneShard) {
  for (std::size_t run = 0; run < 100; ++run) {
    int in = 0;
    for (std::size_t index = 1; index <= 7; ++index) in += Shard{index, 7}.has(run);
    EXPECT_EQ(in, 1);
  }
}

TEST(CampaignShards, OneThatIsMissingOrOfAnotherCampaignIsNamed) {
  const ScratchFolder folder;
  write_all(folder / "shards", drawn_campaign(1, 3, 4), 3);
  const auto message = [&] {
    try {
      merge_shards(folder / "shards", 3);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "");
  CampaignRuns other = drawn_campaign(1, 3, 4);
  other.identity = "abd";
  write_shard(shard_file(folder / "shards", {2, 3}), other, {2, 3});
  EXPECT_NE(message().find("2-of-3.json"), std::string::npos);
  std::filesystem::remove(shard_file(folder / "shards", {2, 3}));
  EXPECT_NE(message().find("2-of-3.json"), std::string::npos);
  std::filesystem::copy_file(shard_file(folder / "shards", {1, 3}), shard_file(folder / "shards", {2, 3}));
  EXPECT_NE(message().find("it is not shard 2/3"), std::string::npos);
}

TEST(CampaignShards, DamagedFilesAreRefusedOrReadWithinTheirRanges) {
  const ScratchFolder folder;
  const std::filesystem::path file = shard_file(folder / "shards", {1, 2});
  write_shard(file, drawn_campaign(4, 2, 3), {1, 2});
  const std::string whole = read_file(file);
  std::mt19937_64 dice(5);
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string damaged = whole;
    if (dice() % 3 == 0) damaged.resize(dice() % damaged.size());
    for (int k = 0; k < 3 && !damaged.empty(); ++k)
      damaged[dice() % damaged.size()] = "0123456789-eE.\"{}[],:xnull"[dice() % 26];
    std::ofstream(file, std::ios::binary) << damaged;
    try {
      const CampaignRuns read = read_shard(file, {1, 2});
      EXPECT_LE(std::abs(read.target_mm), 1e4);
      EXPECT_EQ(read.runs.size(), read.each * read.names.size());
    } catch (const ConfigError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
}

TEST(CampaignShards, AreGivenAsPartAndNumberOfParts) {
  EXPECT_EQ(parse_shard("1/1"), (Shard{1, 1}));
  EXPECT_EQ(parse_shard("64/100000"), (Shard{64, 100'000}));
  for (const char* wrong : {"", "/", "1", "1/", "/2", "0/2", "3/2", "1/2/3", "1/100001", "-1/2", "1/-2",
                            " 1/2", "1/2 ", "1.0/2", "99999999999999999999/99999999999999999999"})
    EXPECT_THROW(parse_shard(wrong), ConfigError) << wrong;
}

}  // namespace
}  // namespace biopsy::robot
