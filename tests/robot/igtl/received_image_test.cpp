// An IMAGE message that comes while the console is open: as bytes by the protocol's description
// (image_message.hpp), through the navigation server's folder, to a plan on it. Image: the built-in phantom.
#include "tests/robot/console/session/held_run.hpp"
#include "tests/robot/igtl/image_message.hpp"

namespace biopsy::robot {
namespace {

using namespace std::chrono_literals;

struct ReceivedImage : testing::Test {
  ScratchFolder incoming;
  Case given = read_case("gap");

  ReceivedImage() { given.images = {incoming.path(), 0ms, 60s, "R. Nurse"}; }

  igtl::Script send(const Bytes& message) const {
    return told_by_server(message, incoming.path(), igtl::Dialect::Of2013);
  }
  // The first series that the console lists beside its own.
  static std::optional<events::Series> offered(Console& console) {
    for (const auto until = std::chrono::steady_clock::now() + 20s;
         std::chrono::steady_clock::now() < until;) {
      if (console.session.series().all().size() > 1) return console.session.series().all().back();
      for (int i = 0; i < 2'100; ++i) console.receive(Mode::Safe, safety::Hazard::PlanUnconfirmed);
      std::this_thread::yield();
    }
    return std::nullopt;
  }
};

TEST_F(ReceivedImage, IsPlannedOnAtTheOpenConsole) {
  for (const Way& way : {Way{}, Way{.version = 2, .big_endian = false, .ras = false}}) {
    Console console(given);
    const Volume& own = console.session.prepared().image;
    const Target target = console.session.prepared().target;
    Volume sent = own;
    sent.grid.X_SI.translation() += Point(0, 0, 0.5);  // told apart from the case's image
    ASSERT_EQ(send(image_message("T2", sent, way)), (igtl::Script{"STATUS T2 1"}));
    const auto found = offered(console);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->problem, "");
    ASSERT_TRUE(console.open(found->series_uid));
    EXPECT_TRUE(own.grid.X_SI.isApprox(sent.grid.X_SI, 1e-5));
    ASSERT_EQ(own.voxels.size(), sent.voxels.size());
    for (std::size_t n = 0; n < sent.voxels.size(); n += 997)
      EXPECT_NEAR(own.voxels[n], sent.voxels[n], 0.51) << n;  // whole numbers in the second way
    console.plan(target.p_SE, target.p_ST);
    EXPECT_NEAR(console.session.planned().depth, (target.p_ST - target.p_SE).norm(), 1e-6);
  }
}

TEST_F(ReceivedImage, OfThreeColoursIsRefusedToItsSenderAndOfferedToNobody) {
  Console console(given);
  const Volume& own = console.session.prepared().image;
  EXPECT_EQ(send(image_message("colour", own, {.components = 3})),
            (igtl::Script{"STATUS CURRENT_STATUS 12 colour"}));
  EXPECT_TRUE(std::filesystem::is_empty(incoming.path()));
}

}  // namespace
}  // namespace biopsy::robot
