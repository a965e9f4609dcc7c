// IMAGE messages all the way: a navigation program sends the planning image, then the confirmation, as bytes
// that are put together by the protocol's description (image_message.hpp), and the live robot plans on the
// one and judges its depth by the other. Images: the built-in phantom, and what the simulated scanner makes
// of it with a needle.
#include "sim/scanner/scanner.hpp"
#include "tests/robot/igtl/image_message.hpp"
#include "tests/robot/igtl/live_site.hpp"
#include "tests/robot/live/steady_host.hpp"

namespace biopsy::robot {
namespace {

// By a server without a robot, before there is one: the file that it wrote.
std::filesystem::path received(const Bytes& message, const std::filesystem::path& folder) {
  EXPECT_EQ(told_by_server(message, folder, igtl::Dialect::Of2021), (igtl::Script{"STATUS T1 planning 1"}));
  return folder / "igtl-001-T1planning.nrrd";
}

// The case "gap" on an image that came as a message, with a needle that was calibrated.
Case case_on(const std::filesystem::path& image, const Target& target,
             const std::filesystem::path& incoming) {
  Case given = read_case("gap");
  given.phantom = false;
  given.image = image;
  given.depth.reset();
  given.p_SE = target.p_SE, given.p_ST = target.p_ST;
  given.tip_offset =
      TipOffset{.needle = "18G", .sequence = "GRE", .value = Millimetres(0), .sigma = Millimetres(0.2)};
  given.images = {incoming, 200ms, 60s, "R. Nurse"};
  given.rehearsal.scan = Seconds(0.3);
  return given;
}

// What kept it from its claim, or nothing. `changed`: of the way in which the confirmation is sent.
std::string confirm_by_message(std::uint32_t domain, const Way& way, bool is_right) {
  const ScratchFolder first, incoming;
  const PreparedCase phantom = prepare(read_case("gap"), first.path());
  const Plan& by_phantom = std::get<Plan>(phantom.plan);
  const auto file = received(image_message("T1 planning", phantom.image, {}), first.path());
  Site site(domain, case_on(file, by_phantom.target, incoming.path()),
            {"--images-to", incoming.path().string()});
  const Plan& plan = std::get<Plan>(site.prepared.plan);
  EXPECT_EQ(site.prepared.image.voxels, phantom.image.voxels);
  EXPECT_TRUE(site.prepared.image.grid.X_SI.isApprox(phantom.image.grid.X_SI, 1e-6));
  EXPECT_NEAR(plan.target_depth.value, by_phantom.target_depth.value, 1e-3);
  if (site.port == 0)
    return "biopsy-igtl does not listen: " + read_file_if_present(site.folder / "navigation.txt");
  if (!site.in(Mode::Safe)) return site.kept("it was not safe");

  Navigator navigator(site);
  navigator.client.send_bytes(image_message("colour", phantom.image, {.components = 3}));
  EXPECT_EQ(Navigator::missing(navigator.until("STATUS CURRENT_STATUS 12 colour")), "");
  EXPECT_TRUE(std::filesystem::is_empty(incoming.path()));
  if (const std::string wrong = navigator.target(site); !wrong.empty()) return site.kept(wrong);
  if (!site.in(Mode::Armed, 60s)) return site.kept("it was not armed");
  const igtl::Script moved = navigator.command("MOVE_TO_TARGET", "STATUS MOVE_TO_TARGET 1");
  if (const std::string wrong = Navigator::missing(moved); !wrong.empty()) return site.kept(wrong);

  sim::ScanSettings settings;
  settings.needle = sim::NeedleArtefact{.p_SE = plan.X_SR.translation(),
                                        .axis_S = plan.X_SR.linear().col(2),
                                        .tip_depth = plan.steps.back().depth};
  settings.snr = 60.0;
  navigator.client.send_bytes(image_message("scan", sim::scan(phantom.image, settings), way));
  EXPECT_EQ(Navigator::missing(navigator.until("STATUS scan 1")), "");
  Site::wait(60s, [&] { return site.person->accepted > 0 || !site.person->check().verdict.empty(); });
  if (is_right) Site::wait(5s, [&] { return site.person->accepted > 0; });
  const console::events::Checked check = site.person->check();
  const std::string told = fmt::format("{}: {}", check.verdict, check.reason);
  if (check.verdict.empty()) return site.kept("no image was judged");
  fmt::print("planned {:.2f} mm, found {:.2f} mm; {}\n", check.planned, check.found, told);
  if (is_right) {
    if (site.person->mode != Mode::Hold) return site.kept("it was not held");
    EXPECT_EQ(site.person->accepted, 1) << told;
    EXPECT_TRUE(check.tip_found) << told;
    EXPECT_NEAR(check.found, plan.steps.back().depth.value, 0.5) << told;
    EXPECT_LT(std::abs(check.lateral), 0.5) << told;
  } else {
    const int looks = site.person->looks;
    EXPECT_TRUE(
        Site::wait(20s, [&] { return site.person->looks >= looks + 25; }));  // half a second of the robot
    EXPECT_EQ(site.person->accepted, 0) << told;
  }
  navigator.command("STOP", "STATUS STOP 1");
  return {};
}

TEST(LiveImages, ArePlannedOnAndConfirmTheDepthHoweverTheyAreSent) {
  live_tests::on_a_steady_host([] {
    return confirm_by_message(kDomain + 3, {.version = 2, .big_endian = false, .ras = false}, true);
  });
}

// A program that mixes up the frames: the anatomy is not where it was planned.
TEST(LiveImages, OfAnotherFrameThanTheySayConfirmNothing) {
  live_tests::on_a_steady_host(
      [] { return confirm_by_message(kDomain + 4, {.says_the_other = true}, false); });
}

}  // namespace
}  // namespace biopsy::robot
