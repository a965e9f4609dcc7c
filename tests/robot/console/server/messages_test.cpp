// Messages of the page, read strictly, and the parts of the server that need no socket.
#include <gtest/gtest.h>

#include "planner/imaging/io/read_volume.hpp"
#include "robot/common/files/file.hpp"
#include "robot/console/server/command_from_json.hpp"
#include "robot/console/server/lease.hpp"
#include "robot/console/server/nifti_bytes.hpp"
#include "robot/console/server/origin_policy.hpp"
#include "robot/console/server/picked_point.hpp"
#include "robot/console/server/send_queue.hpp"
#include "robot/console/server/telemetry_batch.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/safety/verifies.hpp"
#include "tests/scratch_folder.hpp"

namespace biopsy::console {
namespace {

constexpr const char* kPoint =
    R"({"type":"SetPoint","id":1,"mark":"Entry","series_uid":"1.2","voxel":[1,2,3],"ras_mm":[4,5,6]})";

TEST(ConsoleMessages, ReadsACompleteMessage) {
  const commands::Any any = command_from_json(kPoint);
  const auto& point = std::get<commands::SetPoint>(any);
  EXPECT_EQ(point.mark, Mark::Entry);
  EXPECT_EQ(point.voxel[2], 3.0);
}

TEST(ConsoleMessages, RefusesWhatTheIdlDoesNotAllow) {
  const char* wrong[] = {
      "",
      "[]",
      "{",
      R"({"type":"Nothing","id":1})",
      R"({"type":"Stop"})",
      R"({"type":"Stop","id":-1})",
      R"({"type":"Stop","id":4294967296})",
      R"({"type":"Stop","id":1.5})",
      R"({"type":"Stop","id":"1"})",
      R"({"type":"Stop","id":1,"more":1})",
      R"({"type":"SetTick","id":1,"tick":"Other","on":true,"seal":""})",
      R"({"type":"SetTick","id":1,"tick":"Risks","on":1,"seal":""})",
      R"({"type":"SetPoint","id":1,"mark":"Entry","series_uid":"1","voxel":[1,2],"ras_mm":[4,5,6]})",
      R"({"type":"SetPoint","id":1,"mark":"Entry","series_uid":"1","voxel":[1,2,1e9],"ras_mm":[4,5,6]})",
      R"({"type":"SetPoint","id":1,"mark":"Entry","series_uid":"1","voxel":[1,2,null],"ras_mm":[4,5,6]})",
  };
  for (const char* text : wrong) EXPECT_THROW(command_from_json(text), MessageFault) << text;
}

TEST(ConsoleMessages, EveryTruncatedOrChangedMessageIsReadOrRefused) {
  const std::string whole = kPoint;
  for (std::size_t n = 0; n < whole.size(); ++n)
    for (const char other : {'\0', '"', '{', '9', '\xff'}) {
      std::string changed = whole;
      changed[n] = other;
      for (const std::string& text : {whole.substr(0, n), changed}) {
        try {
          command_from_json(text);
        } catch (const MessageFault&) {
        }
      }
    }
}

TEST(PickedPoint, IsComputedFromTheVoxelAndRefusedWhereThePageDisagrees) {
  Volume image;
  image.grid.size = {10, 20, 30};
  image.grid.X_SI.linear() =
      Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() * 0.5;
  image.grid.X_SI.translation() = Point(5, -6, 7);
  image.identity.series_uid = "1.2.3";
  commands::SetPoint picked;
  picked.series_uid = "1.2.3";
  picked.voxel = {4.25, 10.0, 29.4};
  const Point there = image.grid.X_SI * Eigen::Vector3d(4.25, 10.0, 29.4);
  const auto shown_at = [&](double off_mm) {
    const Point ras = ras_from_lps(there) + Point(0, off_mm, 0);
    picked.ras_mm = {ras.x(), ras.y(), ras.z()};
    return picked_point(image, picked);
  };
  EXPECT_LT((std::get<Point>(shown_at(0.0)) - there).norm(), 1e-9);
  EXPECT_TRUE(std::holds_alternative<Point>(shown_at(0.09)));
  EXPECT_TRUE(std::holds_alternative<std::string>(shown_at(0.11)));
  picked.series_uid = "1.2.4";
  EXPECT_TRUE(std::holds_alternative<std::string>(shown_at(0.0)));
  picked.series_uid = "1.2.3";
  picked.voxel[2] = 29.6;
  EXPECT_TRUE(std::holds_alternative<std::string>(shown_at(0.0)));
}

TEST(NiftiBytes, AreReadBackAtTheSamePosition) {
  sim::PhantomSettings small;
  small.size_mm = {6.0, 8.0, 5.0};
  const Volume image = sim::paper_phantom(small).image;
  const ScratchFolder folder;
  atomic_write(folder.path() / "volume.nii", nifti_bytes(image));
  const Volume back = imaging::read_volume(folder.path() / "volume.nii");
  ASSERT_EQ(back.grid.size, image.grid.size);
  EXPECT_EQ(back.voxels, image.voxels);
  EXPECT_LT((back.grid.X_SI.matrix() - image.grid.X_SI.matrix()).norm(), 1e-4);
}

TEST(OriginPolicy, AcceptsOnlyItsOwnPageWithTheToken) {
  verifies("R-63");
  const OriginPolicy policy(8080, "0123");
  const auto request = [](std::string_view host, std::string_view origin, std::string_view target) {
    return Request{host, origin, target};
  };
  EXPECT_TRUE(policy.is_addressed_to_us(request("127.0.0.1:8080", "", "/")));
  EXPECT_TRUE(policy.is_addressed_to_us(request("localhost:8080", "http://localhost:8080", "/")));
  for (const char* host :
       {"", "127.0.0.1", "127.0.0.1:80", "evil.example:8080", "127.0.0.1.evil.example:8080"})
    EXPECT_FALSE(policy.is_addressed_to_us(request(host, "", "/"))) << host;
  for (const char* origin :
       {"null", "http://evil.example", "https://127.0.0.1:8080", "http://127.0.0.1:8081"})
    EXPECT_FALSE(policy.is_addressed_to_us(request("127.0.0.1:8080", origin, "/"))) << origin;
  EXPECT_FALSE(policy.is_from_our_page(request("127.0.0.1:8080", "", "/live")));
  EXPECT_TRUE(policy.has_token(request("", "", "/live?t=0123")));
  for (const char* target : {"/live", "/live?t=", "/live?t=012", "/live?t=01234", "/live?t=0124"})
    EXPECT_FALSE(policy.has_token(request("", "", target))) << target;
}

TEST(OriginPolicy, TokensAreLongAndUnique) {
  EXPECT_EQ(new_token().size(), 32U);
  EXPECT_NE(new_token(), new_token());
}

TEST(RateLimit, AllowsABurstAndThenAHundredASecond) {
  RateLimit limit;
  int allowed = 0;
  for (int n = 0; n < 10'000; ++n) allowed += limit.allows(1'000'000 + n * 100);  // 10 kHz for a second
  EXPECT_NEAR(allowed, 300, 2);
}

TEST(Lease, OneControlsUntilItReleases) {
  verifies("R-63");
  Lease lease;
  EXPECT_TRUE(lease.take(1));
  EXPECT_FALSE(lease.take(2));
  EXPECT_FALSE(lease.release(2));
  EXPECT_TRUE(lease.release(1));
  EXPECT_TRUE(lease.take(2));
}

TEST(SendQueue, DropsPlotDataOnASlowConnectionButNoAnswer) {
  SendQueue queue;
  const auto text = std::make_shared<const std::string>(1'000, 'x');
  const std::size_t fit = SendQueue::kBestEffortMax_bytes / text->size() + 1;
  for (int n = 0; n < 1'000; ++n) queue.push(text, Reliability::BestEffort);
  for (int n = 0; n < 100; ++n) queue.push(text, Reliability::Reliable);
  EXPECT_FALSE(queue.overflows());
  std::size_t sent = 0;
  for (; !queue.empty(); queue.pop()) ++sent;
  EXPECT_EQ(sent, fit + 100U);
}

TEST(TelemetryBatch, KeepsASpikeOfOneTick) {
  TelemetryBatch batch;
  std::optional<events::Telemetry> message;
  for (int n = 0; n < kBatch_ticks; ++n) {
    EXPECT_FALSE(message);
    message = batch.add({static_cast<double>(n), n == 7 ? 9.0 : 1.0, 1.0, n == 13 ? -8.0 : 2.0, 6.0});
  }
  ASSERT_TRUE(message);
  EXPECT_EQ(message->depth_high, 9.0);
  EXPECT_EQ(message->depth_low, 1.0);
  EXPECT_EQ(message->drive_low, -8.0);
  EXPECT_EQ(message->drive_high, 2.0);
}

TEST(TelemetryBatch, OfARobotAtRestIsTwiceAsLongAndOfAMovingOneNot) {
  TelemetryBatch batch;
  const auto ticks_until_sent = [&](auto depth_mm) {
    for (int n = 1;; ++n)
      if (batch.add({0.0, depth_mm(n), 1.0, 2.0, 6.0})) return n;
  };
  const auto rests = [](int n) { return 1.0 + 0.02 * (n % 3); };
  ticks_until_sent(rests);
  EXPECT_EQ(ticks_until_sent(rests), kStillBatch_ticks);
  EXPECT_EQ(ticks_until_sent([](int n) { return 1.0 + 0.005 * n; }), kBatch_ticks);  // 5 mm/s
  EXPECT_EQ(ticks_until_sent(rests), kBatch_ticks);                                  // other than before
  EXPECT_EQ(ticks_until_sent([](int n) { return n == 3 ? 4.0 : 1.0; }), kBatch_ticks);
  EXPECT_EQ(ticks_until_sent(rests), kBatch_ticks);
  EXPECT_EQ(ticks_until_sent(rests), kStillBatch_ticks);
}

}  // namespace
}  // namespace biopsy::console
