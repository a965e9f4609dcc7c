#include "robot/procedure/campaign/campaign_runs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "robot/common/config_error.hpp"
#include "robot/common/files/file.hpp"
#include "robot/common/statistics.hpp"

namespace biopsy::robot {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;

constexpr double kConfidence = 0.95;
constexpr std::size_t kEntriesMax = 10'000, kRunsMax = 100'000;
constexpr double kMost_mm = 1e4, kMost_ms = 1e9;

EntryResult sum_of(const CampaignRuns& campaign, std::size_t entry) {
  EntryResult sum;
  sum.name = campaign.names[entry];
  std::vector<double> after_ms;
  for (std::size_t i = 0; i < campaign.each; ++i) {
    const CampaignRun& run = campaign.runs[entry * campaign.each + i];
    if (!run.done) continue;
    ++sum.runs;
    sum.began += run.began;
    sum.completed += run.completed;
    sum.beyond += run.beyond_mm > kBeyondMost_mm;
    if (run.completed) sum.completed_off_mm = std::max(sum.completed_off_mm, std::abs(run.off_mm));
    if (sum.runs == 1 || run.beyond_mm > sum.worst_mm) {
      sum.worst_mm = run.beyond_mm;
      sum.worst_seed = campaign.seed + i;
      sum.worst_from_depth_mm = run.from_depth_mm;
    }
    if (run.detected_by.empty()) continue;
    ++sum.detected_by[run.detected_by];
    after_ms.push_back(run.detected_after_ms);
  }
  if (!after_ms.empty()) {
    sum.detected_ms_median = median(after_ms);
    sum.detected_ms_max = *std::max_element(after_ms.begin(), after_ms.end());
  }
  return sum;
}

json to_json(const CampaignRun& run) {
  return {{"began", run.began},
          {"completed", run.completed},
          {"beyond_mm", run.beyond_mm},
          {"off_mm", run.off_mm},
          {"from_depth_mm", run.from_depth_mm},
          {"detected_by", run.detected_by},
          {"detected_after_ms",
           std::isfinite(run.detected_after_ms) ? json(run.detected_after_ms) : json(nullptr)}};
}

// The values of a shard's file, each checked.
class ShardReader {
 public:
  explicit ShardReader(const fs::path& file) : file_(file) {
    document_ = json::parse(read_file(file, "run that shard"), nullptr, false);
    // Of a program that always rendered them.
    if (document_.is_object() && !document_.contains("images_accepted")) document_["images_accepted"] = false;
  }

  CampaignRuns read(const Shard& shard) const {
    check_keys(document_,
               {"shard", "identity", "target_mm", "seed", "images_accepted", "each", "names", "runs"});
    if (text(document_, "shard") != fmt::format("{}/{}", shard.index, shard.count))
      refuse(fmt::format("it is not shard {}/{}", shard.index, shard.count));
    CampaignRuns out;
    out.identity = text(document_, "identity");
    out.target_mm = number(document_, "target_mm", -kMost_mm, kMost_mm);
    out.seed = count(document_, "seed", UINT64_MAX);
    out.images_accepted = yes(document_, "images_accepted");
    out.each = static_cast<std::size_t>(count(document_, "each", kRunsMax));
    for (const json& name : list("names", kEntriesMax)) {
      if (!name.is_string()) refuse("a name is no text");
      out.names.push_back(name.get<std::string>());
    }
    const std::size_t whole = out.each * out.names.size(), others = shard.index - 1;
    const std::size_t own = whole > others ? (whole - others - 1) / shard.count + 1 : 0;
    const json& runs = list("runs", kEntriesMax * kRunsMax);
    if (runs.size() != own) refuse(fmt::format("it holds {} rehearsals of {}", runs.size(), own));
    out.runs.resize(whole);
    for (std::size_t n = 0; n < own; ++n) out.runs[others + n * shard.count] = run(runs[n]);
    return out;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw ConfigError("no shard of a campaign: " + what, file_.string(),
                      "delete it and run that shard again");
  }
  void check_keys(const json& object, std::initializer_list<const char*> keys) const {
    if (!object.is_object() || object.size() != keys.size()) refuse("its values are not those of a shard");
    for (const char* key : keys)
      if (!object.contains(key)) refuse(fmt::format("it has no \"{}\"", key));
  }
  std::string text(const json& object, const char* key) const {
    if (!object[key].is_string()) refuse(fmt::format("\"{}\" is no text", key));
    return object[key].get<std::string>();
  }
  double number(const json& object, const char* key, double low, double high) const {
    const double value = object[key].is_number() ? object[key].get<double>() : NAN;
    if (!(value >= low && value <= high))
      refuse(fmt::format("\"{}\" is no number from {:g} to {:g}", key, low, high));
    return value;
  }
  std::uint64_t count(const json& object, const char* key, std::uint64_t most) const {
    if (!object[key].is_number_unsigned() || object[key].get<std::uint64_t>() > most)
      refuse(fmt::format("\"{}\" is no whole number up to {}", key, most));
    return object[key].get<std::uint64_t>();
  }
  bool yes(const json& object, const char* key) const {
    if (!object[key].is_boolean()) refuse(fmt::format("\"{}\" is neither true nor false", key));
    return object[key].get<bool>();
  }
  const json& list(const char* key, std::size_t most) const {
    if (!document_[key].is_array() || document_[key].size() > most)
      refuse(fmt::format("\"{}\" is no list of at most {}", key, most));
    return document_[key];
  }
  CampaignRun run(const json& one) const {
    check_keys(one, {"began", "completed", "beyond_mm", "off_mm", "from_depth_mm", "detected_by",
                     "detected_after_ms"});
    CampaignRun out{.done = true, .began = yes(one, "began"), .completed = yes(one, "completed")};
    out.beyond_mm = number(one, "beyond_mm", -kMost_mm, kMost_mm);
    out.off_mm = number(one, "off_mm", -kMost_mm, kMost_mm);
    out.from_depth_mm = number(one, "from_depth_mm", -kMost_mm, kMost_mm);
    out.detected_by = text(one, "detected_by");
    if (!one["detected_after_ms"].is_null())
      out.detected_after_ms = number(one, "detected_after_ms", -kMost_ms, kMost_ms);
    return out;
  }

  fs::path file_;
  json document_;
};

}  // namespace

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char *begin = text.data(), *end = begin + text.size();
  const auto [slash, first] = std::from_chars(begin, end, shard.index);
  const bool parted = first == std::errc() && slash != end && *slash == '/';
  const auto [rest, second] = parted ? std::from_chars(slash + 1, end, shard.count)
                                     : std::from_chars_result{begin, std::errc::invalid_argument};
  if (second != std::errc() || rest != end || shard.index < 1 || shard.index > shard.count ||
      shard.count > kShardsMax)
    throw ConfigError(fmt::format("\"{}\" is no shard", text), "--shard",
                      fmt::format("give the shard and how many there are, from 1/1 to {0}/{0}", kShardsMax));
  return shard;
}

double EntryResult::beyond_upper95() const {
  if (runs == 0) return 1.0;
  return boost::math::binomial_distribution<>::find_upper_bound_on_p(runs, beyond, 1.0 - kConfidence);
}

std::vector<EntryResult> entry_results(const CampaignRuns& campaign) {
  std::vector<EntryResult> sums;
  for (std::size_t e = 0; e < campaign.names.size(); ++e) sums.push_back(sum_of(campaign, e));
  return sums;
}

fs::path shard_file(const fs::path& folder, const Shard& shard) {
  return folder / fmt::format("{}-of-{}.json", shard.index, shard.count);
}

void write_shard(const fs::path& file, const CampaignRuns& campaign, const Shard& shard) {
  json document{{"shard", fmt::format("{}/{}", shard.index, shard.count)},
                {"identity", campaign.identity},
                {"target_mm", campaign.target_mm},
                {"seed", campaign.seed},
                {"images_accepted", campaign.images_accepted},
                {"each", campaign.each},
                {"names", campaign.names},
                {"runs", json::array()}};
  for (std::size_t i = 0; i < campaign.runs.size(); ++i)
    if (shard.has(i)) document["runs"].push_back(to_json(campaign.runs[i]));
  atomic_write(file, document.dump(1) + "\n");
}

CampaignRuns read_shard(const fs::path& file, const Shard& shard) {
  return ShardReader(file).read(shard);
}

CampaignRuns merge_shards(const fs::path& folder, std::size_t count) {
  CampaignRuns whole = read_shard(shard_file(folder, {1, count}), {1, count});
  for (std::size_t index = 2; index <= count; ++index) {
    const Shard shard{index, count};
    const fs::path file = shard_file(folder, shard);
    const CampaignRuns part = read_shard(file, shard);
    if (part.identity != whole.identity || part.seed != whole.seed || part.each != whole.each ||
        part.names != whole.names || part.images_accepted != whole.images_accepted ||
        part.target_mm != whole.target_mm)
      throw ConfigError("a shard of another campaign, or of another build of the program", file.string(),
                        "run all shards with the same options and program");
    for (std::size_t i = 0; i < whole.runs.size(); ++i)
      if (shard.has(i)) whole.runs[i] = part.runs[i];
  }
  return whole;
}

}  // namespace biopsy::robot
