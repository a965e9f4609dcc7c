"""Points go to the program and back as files of 3D Slicer. Read and written here with Python's json and by the entries of
Slicer's published schema; the program's own reader and writer take no part. markups_test.py BIOPSY"""

import json
import re
import sys
import unittest

from sample_case import ENTRY, TARGET, SampleCase, lps, text

TYPES = {"Fiducial", "Line", "Angle", "Curve", "ClosedCurve", "Plane", "ROI"}


def checked_points(file):
    """Label to LPS position of every point, after a check of what the schema fixes."""
    content = json.loads(file.read_text(), parse_constant=lambda name: sys.exit(f"{name} is no JSON"))
    assert re.fullmatch(r".*markups-schema-v1\.[0-9]+\.[0-9]+\.json#*", content["@schema"]), content["@schema"]
    points = {}
    for markup in content["markups"]:
        assert markup["type"] in TYPES and markup["coordinateSystem"] == "LPS" and markup["coordinateUnits"] == "mm", markup
        assert isinstance(markup["locked"], bool) and isinstance(markup["name"], str)
        for point in markup["controlPoints"]:
            assert isinstance(point["id"], str) and isinstance(point["label"], str) and isinstance(point["description"], str)
            assert all(isinstance(point[flag], bool) for flag in ("selected", "locked", "visibility"))
            assert point["positionStatus"] == "defined" and len(point["position"]) == 3
            assert point["label"] not in points, point["label"]
            points[point["label"]] = tuple(float(number) for number in point["position"])
    return [markup["type"] for markup in content["markups"]], points


class Markups(SampleCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        assert cls.plan("numbers", "--entry", text(ENTRY), "--target", text(TARGET)).returncode == 0

    @classmethod
    def plan(cls, out, *words):
        return cls.run_biopsy("plan", "--image", "gap/planning", *words, "--out", out)

    def expect_same_plan(self, out, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((self.folder / out / "plan.mrk.json").read_bytes(), (self.folder / "numbers/plan.mrk.json").read_bytes())

    def markups(self, frame, points, **more):
        sign = -1 if frame == "LPS" else 1
        controls = [{"label": label, "position": [sign * p[0], sign * p[1], p[2]], **more} for label, p in points]
        return json.dumps({"@schema": "https://raw.githubusercontent.com/slicer/slicer/master/Modules/Loadable/Markups/Resources"
                                      "/Schema/markups-schema-v1.0.3.json#",
                           "markups": [{"type": "Fiducial", "coordinateSystem": frame, "controlPoints": controls}]})

    def test_plan_is_where_its_points_are(self):
        types, points = checked_points(self.folder / "numbers/plan.mrk.json")
        self.assertEqual(types, ["Line", "Fiducial"])
        self.assertEqual(points["entry"], lps(ENTRY))
        self.assertEqual(points["target"], lps(TARGET))
        way = [t - e for e, t in zip(lps(ENTRY), lps(TARGET))]
        length = sum(x * x for x in way) ** 0.5
        stages = {label: p for label, p in points.items() if label.startswith("stage ")}
        self.assertEqual(len(points), 2 + len(stages))
        depths = [float(re.fullmatch(r"stage [0-9]+: ([0-9.]+) mm", label).group(1)) for label in stages]
        self.assertAlmostEqual(depths[-1], length, delta=0.005)
        for depth, p in zip(depths, stages.values()):  # without fiducials the guide is aimed exactly
            for e, w, x in zip(lps(ENTRY), way, p):
                self.assertAlmostEqual(x, e + w * depth / length, delta=0.006)  # of a label with two decimals

    def test_plan_comes_back_as_a_plan(self):
        self.expect_same_plan("again", self.plan("again", "--markups", "numbers/plan.mrk.json"))

    def test_markups_in_either_frame_plan_the_same(self):
        for frame in ("RAS", "LPS"):
            (self.folder / f"{frame}.mrk.json").write_text(self.markups(frame, [("F-1", ENTRY), ("F-2", TARGET)]))
            self.expect_same_plan(frame, self.plan(frame, "--markups", f"{frame}.mrk.json", "--entry", "F-1", "--target", "F-2"))

    def test_fcsv_of_both_generations_plans_the_same(self):
        for version, frame, sign, more in (("4.10", "0", 1, ""), ("4.11", "LPS", -1, ""), ("5.6", "LPS", -1, ",2,0"), ("5.6", "RAS", 1, ",2,0")):
            rows = [f"{n},{sign * p[0]},{sign * p[1]},{p[2]},0,0,0,1,1,1,0,{label},,{more}"
                    for n, (label, p) in enumerate((("entry", ENTRY), ("target", TARGET)), 1)]
            (self.folder / "points.fcsv").write_text("\n".join(
                [f"# Markups fiducial file version = {version}", f"# CoordinateSystem = {frame}",
                 "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID", *rows, ""]))
            self.expect_same_plan("fcsv", self.plan("fcsv", "--markups", "points.fcsv"))

    def test_case_file_takes_them(self):
        (self.folder / "case.mrk.json").write_text(self.markups("LPS", [("here", ENTRY), ("there", TARGET)]))
        (self.folder / "case.toml").write_text('[image]\npath = "gap/planning"\n[target]\nmarkups = "case.mrk.json"\n'
                                               'entry_label = "here"\ntarget_label = "there"\n')
        self.expect_same_plan("case", self.run_biopsy("plan", "case.toml", "--out", "case"))

    def test_uncertain_points_are_refused(self):
        for points, more, why in (
                ([("entry", ENTRY), ("Entry", TARGET), ("target", TARGET)], {}, "two points have the label"),
                ([("entry", ENTRY)], {}, 'no point has the label "target"'),
                ([("entry", ENTRY), ("target", TARGET)], {"positionStatus": "preview"}, "was not placed"),
                ([("entry", ENTRY), ("target", (9e3, 0, 0))], {}, "more than 2 m")):
            (self.folder / "bad.mrk.json").write_text(self.markups("LPS", points, **more))
            result = self.plan("bad", "--markups", "bad.mrk.json")
            self.assertEqual(result.returncode, 2, why)
            self.assertIn(why, result.stderr)
            self.assertIn("bad.mrk.json", result.stderr)
        self.assertFalse((self.folder / "bad").exists())


if __name__ == "__main__":
    unittest.main()
