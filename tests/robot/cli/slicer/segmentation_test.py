"""Tissues of the planning image as a segmentation: DICOM SEG written by pydicom, .seg.nrrd written here by its definition. The
tissues are half spaces across the needle's path, so that their borders are known without a label map. Runs the program with
both. segmentation_test.py BIOPSY"""

import gzip
import pathlib
import subprocess
import sys
import tempfile
import unittest

try:
    import numpy
    import pydicom
    import pydicom.uid
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

BIOPSY = sys.argv.pop()
ENTRY, TARGET = (-4.396, 33.092, 51.854), (-6.737, 33.183, 50.982)  # R, A, S mm, in the built-in case's image
BORDER_MM = 1.4  # muscle until there, liver behind
LESION_MM = 2.0  # and a lesion, in the liver, from here
NAMES = {1: "muscle", 2: "liver", 3: "lesion"}


def lps(point):
    return numpy.array([-point[0], -point[1], point[2]])


class Image:
    """The planning series: voxels k, j, i and the place of each."""

    def __init__(self, folder):
        slices = sorted((pydicom.dcmread(file) for file in folder.iterdir()), key=lambda s: self.height(s))
        self.slices, first, last = slices, slices[0], slices[-1]
        row, column = (numpy.array(first.ImageOrientationPatient[n:n + 3], float) for n in (0, 3))
        self.origin = numpy.array(first.ImagePositionPatient, float)
        self.i = row * float(first.PixelSpacing[1])
        self.j = column * float(first.PixelSpacing[0])
        self.k = (numpy.array(last.ImagePositionPatient, float) - self.origin) / (len(slices) - 1)
        self.shape = (len(slices), first.Rows, first.Columns)
        k, j, i = numpy.indices(self.shape)
        places = self.origin + i[..., None] * self.i + j[..., None] * self.j + k[..., None] * self.k
        way = lps(TARGET) - lps(ENTRY)
        self.depth = (places - lps(ENTRY)) @ (way / numpy.linalg.norm(way))

    @staticmethod
    def height(one):
        row, column = (numpy.array(one.ImageOrientationPatient[n:n + 3], float) for n in (0, 3))
        return float(numpy.cross(row, column) @ numpy.array(one.ImagePositionPatient, float))

    def segments(self):
        return {1: self.depth < BORDER_MM, 2: self.depth >= BORDER_MM, 3: self.depth >= LESION_MM}


def item(**elements):
    one = pydicom.Dataset()
    for name, value in elements.items():
        setattr(one, name, value)
    return one


def write_seg(image, file, keep=lambda number, k, mask: mask.any(), **changes):
    """Frames segment by segment, from the highest slice down, those that are empty left out as other programs do."""
    frames, groups = [], []
    for number, mask in image.segments().items():
        for k in reversed(range(image.shape[0])):
            if not keep(number, k, mask[k]):
                continue
            frames.append(mask[k])
            groups.append(item(
                PlanePositionSequence=[item(ImagePositionPatient=[f"{x:.9g}" for x in image.origin + k * image.k])],
                SegmentIdentificationSequence=[item(ReferencedSegmentNumber=number)]))
    first = image.slices[0]
    data = pydicom.Dataset()
    data.SOPClassUID = pydicom.uid.UID("1.2.840.10008.5.1.4.1.1.66.4")
    data.SOPInstanceUID = pydicom.uid.generate_uid(entropy_srcs=["segmentation"])
    data.Modality = "SEG"
    data.PatientID, data.PatientName = first.PatientID, first.PatientName
    data.StudyInstanceUID = first.StudyInstanceUID
    data.SeriesInstanceUID = pydicom.uid.generate_uid(entropy_srcs=["series"])
    data.FrameOfReferenceUID = first.FrameOfReferenceUID
    data.ImageType = ["DERIVED", "PRIMARY"]
    data.SegmentationType = "BINARY"
    data.SamplesPerPixel, data.PhotometricInterpretation = 1, "MONOCHROME2"
    data.BitsAllocated, data.BitsStored, data.HighBit, data.PixelRepresentation = 1, 1, 0, 0
    _, data.Rows, data.Columns = image.shape
    data.NumberOfFrames = len(frames)
    data.SegmentSequence = [item(SegmentNumber=number, SegmentLabel=name, SegmentAlgorithmType="MANUAL") for number, name in NAMES.items()]
    gap = float(numpy.linalg.norm(image.k))
    data.SharedFunctionalGroupsSequence = [item(
        PlaneOrientationSequence=[item(ImageOrientationPatient=first.ImageOrientationPatient)],
        PixelMeasuresSequence=[item(PixelSpacing=first.PixelSpacing, SliceThickness=f"{gap:.9g}", SpacingBetweenSlices=f"{gap:.9g}")])]
    data.PerFrameFunctionalGroupsSequence = groups
    bits = numpy.packbits(numpy.stack(frames).reshape(-1), bitorder="little").tobytes()
    data.PixelData = bits + b"\0" * (len(bits) % 2)
    for name, value in changes.items():
        setattr(data, name, value)
    data.file_meta = pydicom.dataset.FileMetaDataset()
    data.file_meta.MediaStorageSOPClassUID, data.file_meta.MediaStorageSOPInstanceUID = data.SOPClassUID, data.SOPInstanceUID
    data.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    data.is_little_endian, data.is_implicit_VR = True, False
    pydicom.dcmwrite(file, data, write_like_original=False)


def write_seg_nrrd(image, file):
    """Two layers: muscle and liver share one, the lesion overlaps. Cut to the slices that have a border."""
    masks = image.segments()
    flat = masks[1] * 1 + masks[2] * 2
    border = numpy.nonzero(masks[1].any((1, 2)) & masks[2].any((1, 2)))[0]
    low, high = border[0], border[-1] + 1
    voxels = numpy.stack([flat, masks[3] * 1], axis=-1)[low:high].astype(numpy.uint8)

    def vector(v):
        return "(" + ",".join(f"{x:.12g}" for x in v) + ")"

    header = [
        "NRRD0004", "type: unsigned char", "dimension: 4", "space: left-posterior-superior",
        "sizes: 2 {2} {1} {0}".format(*voxels.shape), f"space directions: none {vector(image.i)} {vector(image.j)} {vector(image.k)}",
        "kinds: list domain domain domain", "encoding: gzip", "space origin: " + vector(image.origin + low * image.k),
        "Segmentation_MasterRepresentation:=Binary labelmap"]
    for n, (name, layer, value) in enumerate((("muscle", 0, 1), ("liver", 0, 2), ("lesion", 1, 1))):
        header += [f"Segment{n}_ID:=Segment_{n}", f"Segment{n}_Name:={name}", f"Segment{n}_Layer:={layer}", f"Segment{n}_LabelValue:={value}"]
    file.write_bytes(("\n".join(header) + "\n\n").encode() + gzip.compress(voxels.tobytes()))


class Segmentation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        result = cls.run_biopsy("plan", "gap", "--out", "gap")
        assert result.returncode == 0, result.stderr
        cls.image = Image(cls.folder / "gap/planning")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    @classmethod
    def run_biopsy(cls, *words):
        return subprocess.run([BIOPSY, *words], cwd=cls.folder, capture_output=True, text=True, timeout=300)

    def plan(self, labels):
        return self.run_biopsy("plan", "--image", "gap/planning", "--entry", ",".join(map(str, ENTRY)), "--target", ",".join(map(str, TARGET)),
                               "--labels", labels, "--out", "out")

    def expect_layers(self, labels):
        result = self.plan(labels)
        self.assertEqual(result.returncode, 0, result.stderr)
        line = next(line for line in result.stdout.splitlines() if "muscle" in line and "|" in line)
        layers = [part.split() for part in line[line.index("muscle"):].removesuffix(" mm").split("|")]
        self.assertEqual([" ".join(part[:-3]) for part in layers], ["muscle", "liver", "liver + lesion"], line)
        ends = [float(part[-1]) for part in layers]
        voxel = max(numpy.linalg.norm(v) for v in (self.image.i, self.image.j, self.image.k))
        self.assertAlmostEqual(ends[0], BORDER_MM, delta=0.87 * voxel)  # half a voxel's diagonal
        self.assertAlmostEqual(ends[1], LESION_MM, delta=0.87 * voxel)
        return result

    def expect_refused(self, labels, why, where=None):
        result = self.plan(labels)
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn(why, result.stderr)
        self.assertIn(where or labels, result.stderr)

    def test_dicom_segmentation_gives_the_layers(self):
        write_seg(self.image, self.folder / "seg.dcm")
        self.expect_layers("seg.dcm")
        (self.folder / "series").mkdir()
        write_seg(self.image, self.folder / "series/IM0001")
        self.expect_layers("series")

    def test_slices_without_a_frame_are_empty(self):
        """Only slices with a border in them, as from a program that leaves out what it calls background."""
        write_seg(self.image, self.folder / "few.dcm", keep=lambda number, k, mask: mask.any() and not mask.all())
        self.expect_layers("few.dcm")

    def test_seg_nrrd_in_layers_gives_the_same(self):
        write_seg_nrrd(self.image, self.folder / "tissue.seg.nrrd")
        self.expect_layers("tissue.seg.nrrd")

    def test_uncertain_segmentations_are_refused(self):
        segments = [item(SegmentNumber=1, SegmentLabel="a"), item(SegmentNumber=1, SegmentLabel="b")]
        for n, (changes, why) in enumerate((
                ({"SegmentationType": "FRACTIONAL"}, "FRACTIONAL"),
                ({"BitsAllocated": 8}, "one bit a pixel"),
                ({"SegmentSequence": segments}, "two segments have the number 1"),
                ({"SegmentSequence": segments[:1]}, "segment 2, which is not described"),
                ({"NumberOfFrames": 100000}, "NumberOfFrames"),
                ({"PixelData": b"\1\0"}, "truncated"),
                ({"FrameOfReferenceUID": "1.2.3"}, "another frame of reference"))):
            write_seg(self.image, self.folder / f"bad{n}.dcm", **changes)
            self.expect_refused(f"bad{n}.dcm", why, where="labels" if "another frame" in why else None)

    def test_damaged_files_are_read_or_refused(self):
        write_seg(self.image, self.folder / "whole.dcm")
        whole = (self.folder / "whole.dcm").read_bytes()
        head = len(whole) - len(pydicom.dcmread(self.folder / "whole.dcm").PixelData)
        random = numpy.random.default_rng(27)
        codes = set()
        for _ in range(12):
            content = bytearray(whole)
            for at in random.integers(132, head, 3):
                content[at] = random.integers(256)
            (self.folder / "damaged.dcm").write_bytes(content[:random.integers(head, len(content))] if random.integers(3) == 0 else content)
            codes.add(self.plan("damaged.dcm").returncode)
        self.assertLessEqual(codes, {0, 2, 3})


if __name__ == "__main__":
    unittest.main()
