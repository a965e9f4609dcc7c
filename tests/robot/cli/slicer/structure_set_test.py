"""The plan as a DICOM RT structure set, read by pydicom and held against PS3.3 A.19 and against the image's own headers; by dciodvfy
of dicom3tools too, where it is installed. structure_set_test.py BIOPSY"""

import json
import re
import shutil
import subprocess
import sys
import unittest

try:
    import numpy
    import pydicom
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample_case import ENTRY, TARGET, SampleCase, lps, text

PATIENT_AND_STUDY = ("PatientName", "PatientID", "PatientBirthDate", "PatientSex", "StudyInstanceUID", "StudyDate", "StudyTime",
                     "ReferringPhysicianName", "StudyID", "AccessionNumber", "FrameOfReferenceUID", "PositionReferenceIndicator")
# Attributes of type 1, which have a value, and of type 2, which may be empty.
TYPE_1 = ("SOPClassUID", "SOPInstanceUID", "Modality", "SeriesInstanceUID", "StructureSetLabel", "StructureSetROISequence",
          "ROIContourSequence", "RTROIObservationsSequence", "ApprovalStatus")
TYPE_2 = ("SeriesNumber", "OperatorsName", "Manufacturer", "StructureSetDate", "StructureSetTime")
BEYOND_THE_STROKE = (-24.0, 26.0, 46.0)  # R, A, S mm, within the image


class StructureSet(SampleCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.slices = [pydicom.dcmread(file) for file in sorted((cls.folder / "gap/planning").iterdir())]
        # Of a patient with a name that is no ASCII, in an order that is not the position's.
        (cls.folder / "named").mkdir()
        for n, one in enumerate(cls.slices):
            one = pydicom.dcmread(one.filename)
            one.SpecificCharacterSet, one.PatientName, one.PatientID = "ISO_IR 100", "Müller^Jörg", "4711"
            one.PatientBirthDate, one.PatientSex, one.StudyID, one.AccessionNumber = "19470412", "M", "S1", "A77"
            one.StudyTime, one.ReferringPhysicianName, one.PositionReferenceIndicator = "101112", "Özil^A", "SN"
            one.save_as(cls.folder / f"named/IM{(7 * n) % 1000:04}")
        result = cls.plan("points", "--image", "named")
        assert result.returncode == 0, result.stderr

    @classmethod
    def plan(cls, out, *words, target=TARGET):
        return cls.run_biopsy("plan", *words, "--entry", text(ENTRY), "--target", text(target), "--out", out)

    def structures(self, out):
        data = pydicom.dcmread(self.folder / out / "plan.rtss.dcm")
        contours = {int(one.ReferencedROINumber): one.ContourSequence for one in data.ROIContourSequence}
        found = {}
        for roi in data.StructureSetROISequence:
            self.assertEqual(roi.ReferencedFrameOfReferenceUID, data.FrameOfReferenceUID)
            self.assertIn("ROIGenerationAlgorithm", roi)
            self.assertEqual(len(contours[int(roi.ROINumber)]), 1)
            contour = contours[int(roi.ROINumber)][0]
            points = numpy.array(contour.ContourData, float).reshape(-1, 3)
            self.assertEqual(contour.NumberOfContourPoints, len(points))
            found[roi.ROIName] = (contour.ContourGeometricType, points)
        self.assertEqual(sorted(contours), [int(roi.ROINumber) for roi in data.StructureSetROISequence])
        self.assertEqual(sorted(int(one.ReferencedROINumber) for one in data.RTROIObservationsSequence), sorted(contours))
        self.assertTrue(all("RTROIInterpretedType" in one and "ROIInterpreter" in one for one in data.RTROIObservationsSequence))
        return data, found

    def test_it_is_of_the_image_s_patient_study_and_frame(self):
        data, _ = self.structures("points")
        image = pydicom.dcmread(next((self.folder / "named").iterdir()))
        self.assertEqual(data.SOPClassUID, "1.2.840.10008.5.1.4.1.1.481.3")
        self.assertEqual(data.file_meta.MediaStorageSOPInstanceUID, data.SOPInstanceUID)
        self.assertEqual(data.Modality, "RTSTRUCT")
        for name in PATIENT_AND_STUDY:
            self.assertEqual(str(data[name].value), str(image[name].value), name)
        self.assertNotEqual(data.SeriesInstanceUID, image.SeriesInstanceUID)
        for name in TYPE_1:
            self.assertTrue(data[name].value, name)
        for name in TYPE_2:
            self.assertIn(name, data)
        for uid in (data.SOPInstanceUID, data.SeriesInstanceUID):
            self.assertTrue(re.fullmatch(r"2\.25\.[1-9][0-9]*", uid) and len(uid) <= 64, uid)

    def test_it_refers_to_every_slice_of_the_image(self):
        data, _ = self.structures("points")
        [frame] = data.ReferencedFrameOfReferenceSequence
        [study] = frame.RTReferencedStudySequence
        [series] = study.RTReferencedSeriesSequence
        self.assertEqual(frame.FrameOfReferenceUID, self.slices[0].FrameOfReferenceUID)
        self.assertEqual(study.ReferencedSOPInstanceUID, self.slices[0].StudyInstanceUID)
        self.assertEqual(series.SeriesInstanceUID, self.slices[0].SeriesInstanceUID)
        referred = [(one.ReferencedSOPClassUID, one.ReferencedSOPInstanceUID) for one in series.ContourImageSequence]
        self.assertEqual(sorted(referred), sorted((one.SOPClassUID, one.SOPInstanceUID) for one in self.slices))

    def test_its_structures_are_where_the_plan_is(self):
        _, found = self.structures("points")
        for name, place in (("entry", ENTRY), ("target", TARGET)):
            kind, points = found[name]
            self.assertEqual(kind, "POINT")
            numpy.testing.assert_allclose(points, [lps(place)], atol=1e-4)
        kind, path = found["needle path"]
        self.assertEqual(kind, "OPEN_NONPLANAR")
        numpy.testing.assert_allclose(path, [lps(ENTRY), lps(TARGET)], atol=2e-3)  # without fiducials the guide is aimed exactly
        stages = json.loads((self.folder / "points/plan.mrk.json").read_text())["markups"][1]["controlPoints"]
        self.assertEqual(set(found), {"entry", "target", "needle path", *(stage["label"] for stage in stages)})
        for stage in stages:
            numpy.testing.assert_allclose(found[stage["label"]][1], [stage["position"]], atol=1e-4)

    def test_the_same_plan_is_the_same_file(self):
        self.assertEqual(self.plan("again", "--image", "named").returncode, 0)
        first = (self.folder / "points/plan.rtss.dcm").read_bytes()
        self.assertEqual((self.folder / "again/plan.rtss.dcm").read_bytes(), first)
        nearer = numpy.array(ENTRY) + 0.8 * (numpy.array(TARGET) - ENTRY)
        self.assertEqual(self.plan("nearer", "--image", "named", target=tuple(nearer.round(4))).returncode, 0)
        self.assertNotEqual(self.structures("nearer")[0].SOPInstanceUID, self.structures("points")[0].SOPInstanceUID)

    def test_an_image_that_is_no_dicom_has_none(self):
        slices = sorted(self.slices, key=lambda one: float(numpy.cross(
            one.ImageOrientationPatient[:3], one.ImageOrientationPatient[3:]) @ numpy.array(one.ImagePositionPatient, float)))
        origin, last = (numpy.array(slices[n].ImagePositionPatient, float) for n in (0, -1))
        row, column = (numpy.array(slices[0].ImageOrientationPatient[n:n + 3], float) for n in (0, 3))
        steps = (row * float(slices[0].PixelSpacing[1]), column * float(slices[0].PixelSpacing[0]), (last - origin) / (len(slices) - 1))

        def vector(v):
            return "(" + ",".join(f"{x:.12g}" for x in v) + ")"

        voxels = numpy.stack([one.pixel_array for one in slices]).astype("<f4")
        header = ["NRRD0004", "type: float", "dimension: 3", "space: left-posterior-superior",
                  "sizes: {2} {1} {0}".format(*voxels.shape), "space directions: " + " ".join(map(vector, steps)),
                  "kinds: domain domain domain", "endian: little", "encoding: raw", "space origin: " + vector(origin)]
        (self.folder / "planning.nrrd").write_bytes(("\n".join(header) + "\n\n").encode() + voxels.tobytes())
        result = self.plan("points-nrrd", "--image", "planning.nrrd")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((self.folder / "points-nrrd/plan.mrk.json").exists())
        self.assertFalse((self.folder / "points-nrrd/plan.rtss.dcm").exists())

    def test_a_refused_plan_leaves_no_earlier_one(self):
        shutil.copytree(self.folder / "points", self.folder / "refused")
        self.assertEqual(self.plan("refused", "--image", "named", target=BEYOND_THE_STROKE).returncode, 3)
        self.assertEqual(sorted(self.folder.glob("refused/plan.*")), [])

    def test_a_point_outside_the_image_changes_nothing(self):
        shutil.copytree(self.folder / "points", self.folder / "kept")
        before = {file: file.read_bytes() for file in (self.folder / "kept").iterdir()}
        self.assertEqual(self.plan("kept", "--image", "named", target=(-60.0, 33.0, 51.0)).returncode, 2)
        self.assertEqual({file: file.read_bytes() for file in (self.folder / "kept").iterdir()}, before)

    def test_it_may_lie_among_the_images(self):
        shutil.copytree(self.folder / "named", self.folder / "both")
        shutil.copy(self.folder / "points/plan.rtss.dcm", self.folder / "both")
        result = self.plan("with", "--image", "both")
        self.assertEqual(result.returncode, 0, result.stderr)

    @unittest.skipUnless(shutil.which("dciodvfy"), "dicom3tools is not installed")
    def test_another_program_finds_no_error(self):
        result = subprocess.run(["dciodvfy", self.folder / "points/plan.rtss.dcm"], capture_output=True, text=True)
        told = result.stdout + result.stderr
        self.assertNotIn("Error", told)
        self.assertIn("RTStructureSet", told)


if __name__ == "__main__":
    unittest.main()
