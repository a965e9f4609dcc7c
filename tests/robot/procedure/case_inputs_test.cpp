// What a case and its points say of scanner, needle and path. Inputs: case files written here over the
// built-in phantom's image.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "robot/common/config_error.hpp"
#include "robot/cycle/plan_facts.hpp"
#include "robot/procedure/case/prepared_case.hpp"
#include "robot/procedure/procedure.hpp"
#include "sim/scanner/dicom_series.hpp"
#include "sim/scanner/phantom.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_dir.hpp"

namespace biopsy::robot {
namespace {

const std::string kPhantomCase = "[image]\nphantom = \"paper\"\n[target]\ndepth_mm = 2.5\n";

Case case_with(const std::string& tables) {
  ScratchFolder folder;
  write_content(folder / "case.toml", kPhantomCase + tables);
  return read_case((folder / "case.toml").string());
}

TEST(CaseFile, ReadsNeedleAndSequenceOfTheSimulatedScanner) {
  const Rehearsal none = case_with("").rehearsal;
  EXPECT_FALSE(none.needle);
  const Rehearsal given = case_with(
                              "[rehearsal]\ncoil_shading = 0.3\nghost = 0.05\nghost_shift_voxels = 12\n"
                              "[rehearsal.needle]\nmaterial = \"nitinol\"\ndiameter_mm = 0.9\n"
                              "[rehearsal.sequence]\necho = \"spin\"\nfield_T = 3.0\nread_axis = \"column\"\n"
                              "field_direction_ras = [0, 1, 0]\nslice_profile = \"gaussian\"\n")
                              .rehearsal;
  ASSERT_TRUE(given.needle);
  EXPECT_EQ(given.needle->susceptibility_ppm, 245.0);
  EXPECT_EQ(given.needle->diameter.value, 0.9);
  EXPECT_EQ(given.sequence.echo, sim::Sequence::Echo::Spin);
  EXPECT_EQ(given.sequence.read_axis, 1);
  EXPECT_TRUE(given.sequence.b0_S.isApprox(-Direction::UnitY()));
  EXPECT_EQ(given.ghost_shift_voxels, 12);
}

TEST(CaseFile, RefusesNeedlesAndSequencesThatAreNone) {
  for (const char* tables :
       {"[rehearsal.needle]\nmaterial = \"wood\"\n", "[rehearsal.needle]\ndiameter_mm = 50\n",
        "[rehearsal.needle]\nmaterial = \"glass\"\nsusceptibility_ppm = 3\n",
        "[rehearsal.needle]\ncolour = \"red\"\n", "[rehearsal.sequence]\necho = \"stimulated\"\n",
        "[rehearsal.sequence]\nfield_T = 99\n", "[rehearsal.sequence]\nbandwidth_Hz_per_pixel = 0\n",
        "[rehearsal.sequence]\nfield_direction_ras = [0, 0]\n", "[rehearsal]\nghost = 2\n"})
    EXPECT_THROW(case_with(tables), ConfigError) << tables;
}

// Three points about the scanner's centre, as 3D Slicer writes them.
const std::string kMarkups = R"({"@schema": "https://x/markups-schema-v1.0.3.json#", "markups": [
  {"type": "Fiducial", "coordinateSystem": "RAS", "coordinateUnits": "mm", "controlPoints": [
    {"label": "entry", "position": [1, 2, 3]}, {"label": "target", "position": [4, 5, 6]},
    {"label": "F-3", "position": [7, 8, 9]}]}]})";

Case case_with_target(const std::string& entries, const std::string& image = "path = \"scan.nii\"") {
  ScratchFolder folder;
  write_content(folder / "points.mrk.json", kMarkups);
  write_content(folder / "case.toml", "[image]\n" + image + "\n[target]\n" + entries);
  return read_case((folder / "case.toml").string());
}

TEST(CaseFile, TakesEntryAndTargetFromMarkups) {
  const Case plain = case_with_target("markups = \"points.mrk.json\"\n");
  EXPECT_EQ(*plain.p_SE, Point(-1, -2, 3));
  EXPECT_EQ(*plain.p_ST, Point(-4, -5, 6));
  EXPECT_EQ(plain.markups.filename(), "points.mrk.json");
  const Case named =
      case_with_target("markups = \"points.mrk.json\"\nentry_label = \"target\"\ntarget_label = \"F-3\"\n");
  EXPECT_EQ(*named.p_SE, Point(-4, -5, 6));
  EXPECT_EQ(*named.p_ST, Point(-7, -8, 9));
}

TEST(CaseFile, RefusesMarkupsBesideOtherPoints) {
  for (const char* entries :
       {"markups = \"points.mrk.json\"\nentry_ras_mm = [1, 2, 3]\n",
        "markups = \"points.mrk.json\"\ndepth_mm = 2\n",
        "markups = \"points.mrk.json\"\ntarget_label = \"F-4\"\n", "markups = \"others.mrk.json\"\n",
        "entry_ras_mm = [1, 2, 3]\ntarget_ras_mm = [1, 2, 6]\nentry_label = \"entry\"\n"})
    EXPECT_THROW(case_with_target(entries), ConfigError) << entries;
  EXPECT_THROW(case_with_target("markups = \"points.mrk.json\"\n", "phantom = \"paper\""), ConfigError);
}

struct Points : testing::Test {
  ScratchFolder folder, out;
  std::filesystem::path markups;  // a file that says its frame
  sim::Phantom phantom = sim::paper_phantom({.voxel = Millimetres(0.5)});

  // The phantom about the scanner's centre, so that each point has a mirror image in it, or where it was.
  PreparedCase prepared(bool central, bool mirrored, Volume* labels = nullptr) {
    Volume image = phantom.image;
    image.identity.frame_of_reference_uid = "1.2.3.99";
    if (labels != nullptr) labels->identity.frame_of_reference_uid = "1.2.3.99";
    const Point centre = image.grid.X_SI * (0.5 * (image.grid.size.cast<double>().array() - 1.0)).matrix();
    Point p_SE = phantom.p_SE;
    if (central) image.grid.X_SI.translation() -= centre, p_SE -= centre;
    if (labels != nullptr) labels->grid = image.grid;
    sim::write_dicom_series(image, folder / "image");
    if (labels != nullptr) sim::write_dicom_series(*labels, folder / "labels");
    Case given = blank_case();
    given.image = folder / "image";
    if (labels != nullptr) given.labels = folder / "labels";
    given.p_SE = p_SE, given.p_ST = p_SE + 4.0 * phantom.axis_S;
    given.markups = markups;
    if (mirrored)
      for (auto* point : {&given.p_SE, &given.p_ST})
        **point = Point(-(**point).x(), -(**point).y(), (**point).z());
    return prepare_run(given, out / "run", {});
  }
};

bool warns(const PreparedCase& prepared, const std::string& of) {
  return std::any_of(prepared.plan_warnings.begin(), prepared.plan_warnings.end(),
                     [&](const std::string& text) { return text.find(of) != std::string::npos; });
}

TEST_F(Points, TypedAsLpsOutsideTheImageAreRefusedWithAHint) {
  try {
    prepared(false, true);
    FAIL() << "points outside the image were taken";
  } catch (const ConfigError& refusal) {
    EXPECT_NE(refusal.what_is_wrong.find("outside the image"), std::string::npos);
    EXPECT_NE(refusal.what_is_wrong.find("L, P, S"), std::string::npos) << refusal.what_is_wrong;
  }
}

TEST_F(Points, ThatFitInBothFramesAreAskedBack) {
  EXPECT_TRUE(warns(prepared(true, false), "were the points typed as R, A, S?"));
}

TEST_F(Points, OfAFileThatSaysItsFrameAreNot) {
  markups = "points.mrk.json";
  EXPECT_FALSE(warns(prepared(true, false), "R, A, S?"));
}

TEST_F(Points, ThatFitInOneFrameAreNot) {
  EXPECT_FALSE(warns(prepared(false, false), "R, A, S?"));
}

TEST_F(Points, OnAPathWithoutALabelAreAWarning) {
  Volume labels = phantom.labels;
  for (float& value : labels.voxels) value = value == 3.0F ? 0.0F : value;  // the liver was not drawn
  const PreparedCase gap = prepared(false, false, &labels);
  EXPECT_TRUE(warns(gap, "have no label"));
}

// The phantom's tissues as 3D Slicer writes a segmentation: numbers of its own, names in the file.
TEST_F(Points, OnAPathThroughSegmentsMeetTissuesByTheirNames) {
  const Grid& grid = phantom.labels.grid;
  const auto vector = [](const Point& v) { return fmt::format("({},{},{})", v.x(), v.y(), v.z()); };
  std::string file = fmt::format(
      "NRRD0004\ntype: unsigned char\ndimension: 3\nspace: left-posterior-superior\nsizes: {} {} {}\n"
      "space directions: {} {} {}\nkinds: domain domain domain\nencoding: raw\nspace origin: {}\n"
      "Segmentation_MasterRepresentation:=Binary labelmap\n",
      grid.size.x(), grid.size.y(), grid.size.z(), vector(grid.X_SI.linear().col(0)),
      vector(grid.X_SI.linear().col(1)), vector(grid.X_SI.linear().col(2)), vector(grid.X_SI.translation()));
  for (int n = 1; n <= 3; ++n)
    file += fmt::format("Segment{0}_LabelValue:={1}\nSegment{0}_Layer:=0\nSegment{0}_Name:={2}\n", n - 1,
                        n + 10, phantom.names[static_cast<std::size_t>(n)]);
  file += '\n';
  for (const float value : phantom.labels.voxels) file += static_cast<char>(value == 0.0F ? 0 : value + 10);
  write_content(folder / "tissue.seg.nrrd", file);

  Case given = blank_case();
  sim::write_dicom_series(phantom.image, folder / "image");
  given.image = folder / "image";
  given.labels = folder / "tissue.seg.nrrd";
  given.p_SE = phantom.p_SE, given.p_ST = phantom.p_SE + 4.0 * phantom.axis_S;
  const PreparedCase by_name = prepare_run(given, out / "run", {});
  ASSERT_EQ(by_name.layers.size(), 3U);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(by_name.layers[n].name, phantom.names[n + 1]);
  given.label_names[13] = "spleen";  // the case's word counts
  EXPECT_EQ(prepare_run(given, out / "run", {}).layers.back().name, "spleen");
}

// Stages: the calibrated one with two to four times the hysteresis of its films.
TEST(PreparedCase, APlanThatTheSupervisorWouldRefuseIsRefusedByThePlanner) {
  const std::string model = file_content(source_dir() / "sim/models/calibrated.toml");
  const std::string value = "loss_V = { value = 294.67883301974274";
  const std::size_t at = model.find(value);
  ASSERT_NE(at, std::string::npos);
  int planned = 0, refused = 0;
  for (int loss_V = 700; loss_V <= 1'040; loss_V += 20) {
    const ScratchFolder folder;
    std::string other = model;
    other.replace(at, value.size(), fmt::format("loss_V = {{ value = {}", loss_V));
    write_content(folder / "stage.toml", other);
    Case given = case_with("");
    given.rehearsal.model = folder / "stage.toml";
    const PreparedCase prepared = prepare(given, folder / "out");
    if (const Plan* plan = std::get_if<Plan>(&prepared.plan)) {
      ++planned;
      EXPECT_TRUE(safety::is_plausible(plan_facts(*plan, 1))) << loss_V << " V";
      continue;
    }
    const PlanRefusal& why = std::get<PlanRefusal>(prepared.plan);
    refused += why.what.find("H-20") != std::string::npos ? 1 : 0;
  }
  EXPECT_GE(planned, 4);
  EXPECT_GE(refused, 4);
}

}  // namespace
}  // namespace biopsy::robot
