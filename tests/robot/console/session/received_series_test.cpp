// Images that come into the watched folder while the console runs are offered for planning. They are written
// as a scanner exports them (DICOM, by the simulated scanner's writer) and as text put together here (NRRD).
#include <chrono>

#include "robot/common/config_error.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/robot/console/session/held_run.hpp"

namespace biopsy::robot {
namespace {

using namespace std::chrono_literals;

struct ReceivedSeries : testing::Test {
  ScratchFolder planning, incoming;
  sim::Phantom phantom = sim::paper_phantom();

  ReceivedSeries() {
    phantom.image.identity.patient_id = "A";
    phantom.image.identity.frame_of_reference_uid = "1.2.3.9";
    export_series("1.2.3.1", planning / "first");
  }
  void export_series(const std::string& uid, const std::filesystem::path& folder) {
    phantom.image.identity.series_uid = uid;
    sim::write_dicom_series(phantom.image, folder);
  }
  Case given(const std::string& confirmed_by = "") const {
    ProcedureOptions options;
    options.image = planning.path();
    Case from = case_of(options, Points::PickedLater);
    from.images.folder = incoming.path();
    from.images.quiet = 0ms;
    from.images.confirmed_by = confirmed_by;
    return from;
  }
  // The series of that name once it is listed; nothing where it does not come.
  static std::optional<events::Series> listed(Console& console, const std::string& uid,
                                              Mode mode = Mode::Safe,
                                              std::chrono::milliseconds patience = 20s) {
    const auto until = std::chrono::steady_clock::now() + patience;
    while (std::chrono::steady_clock::now() < until) {
      for (const events::Series& one : console.session.series().all())
        if (one.series_uid == uid) return one;
      for (int i = 0; i < 2'100; ++i) console.receive(mode, safety::Hazard::PlanUnconfirmed);
      std::this_thread::yield();
    }
    return std::nullopt;
  }
  // 4 x 3 x 3 voxels that name nobody.
  void write_nrrd(const std::string& name) const {
    incoming.write(name,
                   "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 4 3 3\n"
                   "space directions: (1,0,0) (0,1,0) (0,0,2)\nkinds: domain domain domain\nencoding: raw\n"
                   "space origin: (1,2,3)\n\n" +
                       std::string(36, 'x'));
  }
};

TEST_F(ReceivedSeries, ThatComesLaterIsOfferedAndPlannedOn) {
  export_series("1.2.3.2", incoming / "yesterday");  // what lay there before is not offered
  Console console(given());
  ASSERT_EQ(console.session.series().all().size(), 1U);
  export_series("1.2.3.3", incoming / "scan");
  const auto found = listed(console, "1.2.3.3");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->problem, "");
  EXPECT_EQ(found->patient_id, "A");
  EXPECT_NE(found->description.find("received"), std::string::npos);
  ASSERT_TRUE(console.open("1.2.3.3"));
  console.plan(phantom.p_SE, phantom.p_SE + 2.0 * phantom.axis_S);
  EXPECT_NEAR(console.session.planned().depth, 2.0, 1e-9);
  EXPECT_EQ(console.session.series().all().size(), 2U);
}

TEST_F(ReceivedSeries, OfAnotherPatientIsListedAndRefused) {
  Console console(given("R. Nurse"));
  phantom.image.identity.patient_id = "B";
  export_series("1.2.3.4", incoming / "scan");
  const auto found = listed(console, "1.2.3.4");
  ASSERT_TRUE(found);
  EXPECT_NE(found->problem.find("another patient"), std::string::npos);
  EXPECT_FALSE(console.open("1.2.3.4"));
}

TEST_F(ReceivedSeries, ThatNamesNobodyNeedsAPersonWhoAnswersForIt) {
  for (const char* person : {"", "R. Nurse"}) {
    const std::string name = std::string("igtl-001-") + (*person != 0 ? "with" : "without") + ".nrrd";
    Console console(given(person));
    write_nrrd(name);
    const auto found = listed(console, name);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->problem.empty(), *person != 0) << found->problem;
    EXPECT_EQ(console.open(name), *person != 0);
    EXPECT_EQ(console.session.prepared().target.patient_id, "A");  // confirmations are compared with it
  }
}

TEST_F(ReceivedSeries, ThatIsDamagedIsListedWithItsProblem) {
  Console console(given("R. Nurse"));
  incoming.write("broken.nrrd", "NRRD0004\ntype: uint8\n\n");
  const auto found = listed(console, "broken.nrrd");
  ASSERT_TRUE(found);
  EXPECT_NE(found->problem, "");
  write_nrrd("broken.nrrd");  // sent again
  const auto until = std::chrono::steady_clock::now() + 20s;
  while (!console.open("broken.nrrd") && std::chrono::steady_clock::now() < until)
    for (int i = 0; i < 2'100; ++i) console.receive(Mode::Safe, safety::Hazard::PlanUnconfirmed);
  EXPECT_EQ(console.session.prepared().image.grid.size, Eigen::Vector3i(4, 3, 3));
}

TEST_F(ReceivedSeries, IsNotLookedForWhileHighVoltageIsOn) {
  Console console(given());
  console.receive(Mode::Hold, safety::Hazard::None);
  export_series("1.2.3.5", incoming / "scan");
  EXPECT_FALSE(listed(console, "1.2.3.5", Mode::Hold, 300ms));
  EXPECT_TRUE(listed(console, "1.2.3.5"));
}

TEST_F(ReceivedSeries, NeedsTheFolder) {
  Case from = given();
  from.images.folder = incoming / "nowhere";
  EXPECT_THROW(Console{from}, ConfigError);
}

}  // namespace
}  // namespace biopsy::robot
