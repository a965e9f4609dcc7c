// Claims about markups of 3D Slicer. Inputs: texts with the entries that Slicer 4.11, 5.0 and 5.6 write,
// after its published schema and its source of both writers; none was written by this program.
#include "planner/plan/markups/markups_file.hpp"

#include <gtest/gtest.h>

#include <random>

#include "robot/common/config_error.hpp"
#include "tests/safety/verifies.hpp"

namespace biopsy::planner {
namespace {

const std::string kJson = R"({
    "@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources/Schema/markups-schema-v1.0.3.json#",
    "markups": [
        {
            "type": "Fiducial",
            "coordinateSystem": "LPS",
            "coordinateUnits": "mm",
            "locked": false,
            "fixedNumberOfControlPoints": false,
            "labelFormat": "%N-%d",
            "lastUsedControlPointNumber": 3,
            "controlPoints": [
                {
                    "id": "1",
                    "label": "entry",
                    "description": "",
                    "associatedNodeID": "vtkMRMLScalarVolumeNode1",
                    "position": [4.396, -33.092, 51.854],
                    "orientation": [-1.0, -0.0, -0.0, -0.0, -1.0, -0.0, 0.0, 0.0, 1.0],
                    "selected": true,
                    "locked": false,
                    "visibility": true,
                    "positionStatus": "defined"
                },
                {
                    "id": "2",
                    "label": "target",
                    "position": [8.329, -33.244, 50.388],
                    "positionStatus": "defined"
                },
                {
                    "id": "3",
                    "label": "F-3",
                    "position": [0.0, 0.0, 0.0],
                    "positionStatus": "preview"
                }
            ],
            "measurements": [],
            "display": {"visibility": true, "opacity": 1.0, "color": [0.4, 1.0, 1.0], "snapMode": "toVisibleSurface"}
        }
    ]
}
)";

const std::string kFcsv =
    "# Markups fiducial file version = 4.11\n"
    "# CoordinateSystem = 0\n"
    "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n"
    "vtkMRMLMarkupsFiducialNode_0,-4.396,33.092,51.854,0.000,0.000,0.000,1.000,1,1,0,entry,,"
    "vtkMRMLScalarVolumeNode1\n"
    "vtkMRMLMarkupsFiducialNode_1,-8.329,33.244,50.388,0.000,0.000,0.000,1.000,1,1,0,target,\"segment 4, "
    "deep\",\n";

const Point kEntry(4.396, -33.092, 51.854), kTarget(8.329, -33.244, 50.388);  // LPS

std::string with(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

// Any name: the ending decides the format.
void expect_points(const std::string& text, const std::string& file) {
  const auto points = parse_markups(text, file);
  EXPECT_TRUE(point_labelled(points, "entry", file).isApprox(kEntry)) << text;
  EXPECT_TRUE(point_labelled(points, "target", file).isApprox(kTarget)) << text;
}

// A refusal names the file and a remedy, and says `why`.
void expect_refused(const std::string& text, const std::string& file, const std::string& why) {
  try {
    const auto points = parse_markups(text, file);
    point_labelled(points, "entry", file);
    point_labelled(points, "target", file);
    ADD_FAILURE() << "accepted: " << why << "\n" << text;
  } catch (const ConfigError& refusal) {
    EXPECT_EQ(refusal.where.rfind(file, 0), 0U) << refusal.where;
    EXPECT_FALSE(refusal.remedy.empty());
    EXPECT_NE(refusal.what_is_wrong.find(why), std::string::npos) << refusal.what_is_wrong;
  }
}

TEST(MarkupsFile, IsTheSamePlaceInBothFrames) {
  verifies("R-61");
  expect_points(kJson, "points.mrk.json");
  std::string ras = with(kJson, "\"LPS\"", "\"RAS\"");
  ras = with(ras, "[4.396, -33.092, 51.854]", "[-4.396, 33.092, 51.854]");
  ras = with(ras, "[8.329, -33.244, 50.388]", "[-8.329, 33.244, 50.388]");
  expect_points(ras, "points.json");
}

TEST(MarkupsFile, TakesTheStandardsOfTheSchema) {
  expect_points(with(kJson, "\"coordinateSystem\": \"LPS\",", ""), "points.mrk.json");
  expect_points(with(kJson, "\"coordinateUnits\": \"mm\",", ""), "points.mrk.json");
  expect_points(with(kJson, "\"mm\"", R"(["mm", "UCUM", "millimeter"])"), "points.mrk.json");
  expect_points(with(kJson, ",\n                    \"positionStatus\": \"defined\"", ""), "points.mrk.json");
  expect_points(with(kJson, "v1.0.3", "v1.0.0"), "POINTS.MRK.JSON");
}

TEST(MarkupsFile, FindsPointsInEachOfItsMarkups) {
  const std::string two = R"({"@schema": "https://x/markups-schema-v1.0.4.json", "markups": [
    {"type": "Line", "coordinateSystem": "RAS", "controlPoints": [
      {"label": "Entry ", "position": [-4.396, 33.092, 51.854]}, {"label": "L-2", "position": [1, 2, 3]}]},
    {"type": "Fiducial", "controlPoints": [{"label": "TARGET", "position": [8.329, -33.244, 50.388]}]},
    {"type": "ROI"}]})";
  expect_points(two, "points.mrk.json");
}

TEST(MarkupsFile, ReadsFcsvOfSlicer4And5) {
  verifies("R-61");
  expect_points(kFcsv, "points.fcsv");
  expect_points(with(kFcsv, "= 0", "= RAS"), "points.fcsv");
  std::string lps = with(kFcsv, "-4.396,33.092", "4.396,-33.092");
  lps = with(lps, "-8.329,33.244", "8.329,-33.244");
  expect_points(with(lps, "= 0", "= 1"), "points.fcsv");
  lps = with(with(lps, "= 0", "= LPS"), "4.11", "5.6");
  expect_points(lps, "points.fcsv");
  // Slicer 5 adds the status of the position, and who placed it.
  std::string five = with(lps, "vtkMRMLScalarVolumeNode1\n", "vtkMRMLScalarVolumeNode1,2,0\n");
  five.insert(five.size() - 1, ",2,0");
  expect_points(five, "points.FCSV");
  std::string windows;
  for (const char c : five) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  expect_points("\xEF\xBB\xBF" + windows, "points.fcsv");
}

TEST(MarkupsFile, RefusesWhatIsNotCertainInJson) {
  verifies("R-61");
  const std::string file = "points.mrk.json";
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    expect_refused(with(kJson, from, to), file, why);
  };
  refused("\"LPS\"", "\"IJK\"", "neither LPS nor RAS");
  refused("\"LPS\"", "\"lps\"", "neither LPS nor RAS");
  refused("\"LPS\"", "0", "\"coordinateSystem\" is not a text");
  refused("\"mm\"", "\"um\"", "not in mm");
  refused("\"mm\"", "\"cm\"", "not in mm");
  refused("\"mm\"", R"(["um", "UCUM", "micrometer"])", "not in mm");
  refused("\"mm\"", "1", "not in mm");
  refused("\"positionStatus\": \"defined\"", "\"positionStatus\": \"preview\"", "was not placed");
  refused("\"positionStatus\": \"defined\"", "\"positionStatus\": \"undefined\"", "was not placed");
  refused("\"positionStatus\": \"defined\"", "\"positionStatus\": \"missing\"", "position status");
  refused("\"F-3\"", "\"Target\"", "two points have the label \"target\"");
  refused("\"entry\"", "\"F-1\"",
          "no point has the label \"entry\"; its labels are \"F-1\", \"target\", \"F-3\"");
  refused("[4.396, -33.092, 51.854]", "[4.396, -33.092]", "not three numbers");
  refused("[4.396, -33.092, 51.854]", "[4.396, -33.092, \"51.854\"]", "not a number");
  refused("[4.396, -33.092, 51.854]", "[4.396, null, 51.854]", "not a number");
  refused("[4.396, -33.092, 51.854]", "[4.396, 1e999, 51.854]", "not a JSON file");
  refused("[4.396, -33.092, 51.854]", "[4.396, NaN, 51.854]", "not a JSON file");
  refused("[4.396, -33.092, 51.854]", "[4396, -33092, 51854]", "more than 2 m");
  refused("\"position\": [4.396, -33.092, 51.854],", "", "not three numbers");
  refused("\"label\": \"entry\",", "\"label\": \"entry\", \"position\": [1, 2, 3],", "given twice");
  refused("\"label\": \"entry\"", "\"label\": 7", "\"label\" is not a text");
  refused("v1.0.3", "v2.0.0", "@schema");
  refused("markups-schema", "annotations-schema", "@schema");
  refused("\"markups\":", "\"marks\":", "\"markups\" is missing");
  refused("\"type\": \"Fiducial\",", "", "\"type\" is missing");
  expect_refused("[]", file, "not a JSON file");
  expect_refused("", file, "not a JSON file");
  expect_refused(kJson.substr(0, kJson.size() / 2), file, "not a JSON file");
  expect_refused(kJson, "points.txt", "not a file of points");
}

TEST(MarkupsFile, RefusesWhatIsNotCertainInFcsv) {
  verifies("R-61");
  const std::string file = "points.fcsv";
  const auto refused = [&](const std::string& from, const std::string& to, const std::string& why) {
    expect_refused(with(kFcsv, from, to), file, why);
  };
  refused("# CoordinateSystem = 0\n", "", "RAS or LPS is not certain");
  refused("= 0", "= 2", "neither RAS (0) nor LPS (1)");
  refused("= 0", "= IJK", "neither RAS (0) nor LPS (1)");
  refused("= 0", "=", "neither RAS (0) nor LPS (1)");
  refused("= 0\n", "= 0\n# CoordinateSystem = 1\n", "there twice");
  refused("# Markups fiducial file version = 4.11\n", "", "no fiducials of 3D Slicer");
  refused("4.11", "3.6", "version \"3.6\"");
  refused("4.11", "6.0", "version \"6.0\"");
  refused("# columns", "# rows", "# columns");
  refused("id,x,y,z,", "id,x,y,", "`z` is missing");
  refused("id,x,y,z,", "id,z,y,x,", "do not follow each other");
  refused("label,desc", "name,desc", "`label` is missing");
  refused(",-4.396,33.092", ",-4.396,nan", "`y`: \"nan\" is not a finite number");
  refused(",-4.396,33.092", ",-4.396,", "`y`: \"\" is not a finite number");
  refused(",-4.396,33.092", ",-4,396,33,092", "position status");
  refused(",-4.396,33.092", ",-4396,33.092", "more than 2 m");
  refused(",target,", ",entry,", "two points have the label \"entry\": points.fcsv:4 and points.fcsv:5");
  refused("vtkMRMLScalarVolumeNode1\n", "vtkMRMLScalarVolumeNode1,1,0\n", "was not placed");
  refused("vtkMRMLScalarVolumeNode1\n", "vtkMRMLScalarVolumeNode1,7,0\n", "position status");
  refused("vtkMRMLScalarVolumeNode1\n", "vtkMRMLScalarVolumeNode1,2\n", "15 cells");
  refused(",\"segment 4, deep\",", ",segment 4, deep,", "15 cells");
}

// A few bytes changed, cut off or doubled: read or refused, and what is read lies in a scanner. Seeded.
TEST(MarkupsFile, ThatIsDamagedIsReadOrRefused) {
  std::mt19937 random(20261125);
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (const auto& [whole, file] : {std::pair(kJson, "points.mrk.json"), std::pair(kFcsv, "points.fcsv")}) {
    int refused = 0;
    for (int n = 0; n < 2'000; ++n) {
      std::string text = whole;
      if (const std::size_t kind = below(4); kind == 0)
        text.resize(below(text.size()));
      else if (kind == 1)
        text.insert(below(text.size()), text.substr(below(text.size()), 1 + below(40)));
      else
        for (std::size_t changes = 1 + below(4); changes > 0; --changes)
          text[below(text.size())] = static_cast<char>(below(256));
      try {
        for (const MarkupPoint& point : parse_markups(text, file)) {
          const double farthest_mm = point.p_S ? point.p_S->cwiseAbs().maxCoeff() : 0.0;
          EXPECT_LE(farthest_mm, 2000.0) << text;
        }
      } catch (const ConfigError& refusal) {
        EXPECT_FALSE(refusal.what_is_wrong.empty() || refusal.where.empty() || refusal.remedy.empty());
        ++refused;
      }
    }
    EXPECT_GT(refused, 200) << file;
    EXPECT_LT(refused, 2'000) << file;
  }
}

}  // namespace
}  // namespace biopsy::planner
