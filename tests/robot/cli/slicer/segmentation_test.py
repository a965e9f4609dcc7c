"""Tissues of the planning image as a segmentation: DICOM SEG written by pydicom, .seg.nrrd written here by its definition. The
tissues are half spaces across the needle's path, so that their borders are known without a label map. Runs the program with
both. segmentation_test.py BIOPSY"""

import gzip
import sys
import unittest

try:
    import numpy
    import pydicom
    import pydicom.uid
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

from sample_case import ENTRY, TARGET, SampleCase, lps, text

BORDER_MM = 1.4  # muscle until there, liver behind
LESION_MM = 2.0  # and a lesion, in the liver, from here
NAMES = {1: "muscle", 2: "liver", 3: "lesion"}


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
        way = numpy.subtract(lps(TARGET), lps(ENTRY))
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


def write_seg(image, file, keep=lambda number, k, mask: mask.any(), order=None, **changes):
    """Frames segment by segment, from the highest slice down, those that are empty left out as other programs do; or in any order."""
    masks, frames, groups = image.segments(), [], []
    places = [(number, k) for number, mask in masks.items() for k in reversed(range(image.shape[0])) if keep(number, k, mask[k])]
    for number, k in places if order is None else [places[n] for n in order.permutation(len(places))]:
        frames.append(masks[number][k])
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
    return numpy.stack(frames)


def rewritten(file, syntax, frames=None, representation=None, **changes):
    """The file with other elements, in another transfer syntax: `frames` uncompressed, as OB or OW, or a list of its fragments."""
    data = pydicom.dcmread(file)
    for name, value in changes.items():
        setattr(data, name, value)
    if isinstance(frames, list):
        data.PixelData = pydicom.encaps.encapsulate(frames)
        data["PixelData"].is_undefined_length = True
    elif frames is not None:
        content = frames.tobytes()
        data.PixelData = content + b"\0" * (len(content) % 2)
    if representation:
        data["PixelData"].VR = representation
    data.file_meta.TransferSyntaxUID = syntax
    data.is_little_endian = syntax != pydicom.uid.ExplicitVRBigEndian
    pydicom.dcmwrite(file, data, write_like_original=False)


def run_lengths(plane):
    """One 8-bit plane in PackBits behind DICOM's header of 64 bytes (PS3.5 G), row by row."""
    content = bytearray()
    for row in plane:
        at = 0
        while at < len(row):
            run = 1
            while at + run < len(row) and run < 128 and row[at + run] == row[at]:
                run += 1
            content += bytes([257 - run if run > 1 else 0, row[at]])
            at += run
    return numpy.array([1, 64] + 14 * [0], "<u4").tobytes() + bytes(content) + b"\0" * (len(content) % 2)


def fractional(frames, most, shares=(0.2, 0.9)):
    """Inside of a segment the second share of the most is stored, outside the first."""
    return numpy.where(frames, round(shares[1] * most), round(shares[0] * most)).astype(numpy.uint8)


EIGHT_BITS = {"BitsAllocated": 8, "BitsStored": 8, "HighBit": 7}


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


class Segmentation(SampleCase):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.image = Image(cls.folder / "gap/planning")

    def plan(self, labels):
        return self.run_biopsy("plan", "--image", "gap/planning", "--entry", text(ENTRY), "--target", text(TARGET),
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

    def test_frames_may_come_in_any_order(self):
        for seed in (1, 2, 3):
            write_seg(self.image, self.folder / "mixed.dcm", order=numpy.random.default_rng(seed))
            self.expect_layers("mixed.dcm")

    def test_deflated_and_big_endian_bits_are_read(self):
        """DICOM's own deflate; and words whose bytes are turned round, as the retired big endian has them."""
        frames = write_seg(self.image, self.folder / "deflated.dcm")
        rewritten(self.folder / "deflated.dcm", pydicom.uid.DeflatedExplicitVRLittleEndian)
        self.expect_layers("deflated.dcm")
        write_seg(self.image, self.folder / "turned.dcm")
        bits = numpy.packbits(frames.reshape(-1), bitorder="little")
        words = numpy.append(bits, numpy.zeros(len(bits) % 2, numpy.uint8)).view("<u2")
        for representation, pixels in (("OW", words.astype(">u2")), ("OB", words)):
            rewritten(self.folder / "turned.dcm", pydicom.uid.ExplicitVRBigEndian, pixels, representation)
            self.expect_layers("turned.dcm")

    def test_fractional_segments_are_where_more_than_half_is(self):
        for most, kind in ((255, "PROBABILITY"), (100, "OCCUPANCY"), (1, "OCCUPANCY")):
            frames = write_seg(self.image, self.folder / "share.dcm")
            changes = {**EIGHT_BITS, "SegmentationType": "FRACTIONAL", "SegmentationFractionalType": kind, "MaximumFractionalValue": most}
            rewritten(self.folder / "share.dcm", pydicom.uid.ExplicitVRLittleEndian, fractional(frames, most), **changes)
            self.expect_layers("share.dcm")
            rewritten(self.folder / "share.dcm", pydicom.uid.RLELossless, [run_lengths(plane) for plane in fractional(frames, most)])
            self.expect_layers("share.dcm")

    def test_half_of_the_most_is_outside(self):
        frames = write_seg(self.image, self.folder / "half.dcm", keep=lambda number, k, mask: number < 3 or mask.any())
        pixels = fractional(frames, 100)
        lesion = [n for n, group in enumerate(pydicom.dcmread(self.folder / "half.dcm").PerFrameFunctionalGroupsSequence)
                  if group.SegmentIdentificationSequence[0].ReferencedSegmentNumber == 3]
        pixels[lesion] = fractional(frames[lesion], 100, shares=(0.0, 0.5))
        rewritten(self.folder / "half.dcm", pydicom.uid.ExplicitVRLittleEndian, pixels, **EIGHT_BITS, SegmentationType="FRACTIONAL",
                  SegmentationFractionalType="OCCUPANCY", MaximumFractionalValue=100)
        result = self.plan("half.dcm")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("liver", result.stdout)
        self.assertNotIn("lesion", result.stdout)

    def test_label_map_segments_are_read(self):
        """LABELMAP of 2024: the pixel is the number of its segment, so that segments cannot overlap."""
        masks = self.image.segments()
        flat = numpy.where(masks[3], 3, numpy.where(masks[2], 2, 1)).astype(numpy.uint8)
        write_seg(self.image, self.folder / "map.dcm", keep=lambda number, k, mask: number == 1, order=None)
        groups = [item(PlanePositionSequence=[item(ImagePositionPatient=[f"{x:.9g}" for x in self.image.origin + k * self.image.k])])
                  for k in range(self.image.shape[0])]
        changes = {**EIGHT_BITS, "SOPClassUID": pydicom.uid.UID("1.2.840.10008.5.1.4.1.1.66.7"), "SegmentationType": "LABELMAP",
                   "NumberOfFrames": len(groups), "PerFrameFunctionalGroupsSequence": groups}
        rewritten(self.folder / "map.dcm", pydicom.uid.ExplicitVRLittleEndian, flat, **changes)
        result = self.plan("map.dcm")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"muscle.*liver.*lesion")
        self.assertNotIn("liver + lesion", result.stdout)
        rewritten(self.folder / "map.dcm", pydicom.uid.ExplicitVRLittleEndian, numpy.where(flat == 3, 9, flat).astype(numpy.uint8))
        self.expect_refused("map.dcm", "segment 9, which is not described")

    def test_compressed_bits_and_lossy_shares_are_refused(self):
        frames = write_seg(self.image, self.folder / "packed.dcm")
        rewritten(self.folder / "packed.dcm", pydicom.uid.RLELossless,
                  [run_lengths(numpy.packbits(frame, axis=1, bitorder="little")) for frame in frames])
        self.expect_refused("packed.dcm", "compressed as RLE Lossless: segments of one bit")
        rewritten(self.folder / "packed.dcm", pydicom.uid.RLELossless, [run_lengths(plane) for plane in fractional(frames, 255)],
                  **EIGHT_BITS, SegmentationType="FRACTIONAL", SegmentationFractionalType="OCCUPANCY", MaximumFractionalValue=255,
                  LossyImageCompression="01")
        self.expect_refused("packed.dcm", "compressed with loss")

    def test_seg_nrrd_in_layers_gives_the_same(self):
        write_seg_nrrd(self.image, self.folder / "tissue.seg.nrrd")
        self.expect_layers("tissue.seg.nrrd")

    def test_uncertain_segmentations_are_refused(self):
        segments = [item(SegmentNumber=1, SegmentLabel="a"), item(SegmentNumber=1, SegmentLabel="b")]
        for n, (changes, why) in enumerate((
                ({"SegmentationType": "SURFACE"}, "SURFACE"),
                ({"SegmentationType": "FRACTIONAL"}, "8 bits a pixel"),
                ({"SegmentationType": "FRACTIONAL", **EIGHT_BITS}, "MaximumFractionalValue"),
                ({"SegmentationType": "FRACTIONAL", **EIGHT_BITS, "MaximumFractionalValue": 255}, "truncated"),
                ({"BitsAllocated": 8}, "one bit a pixel"),
                ({"SegmentSequence": segments}, "two segments have the number 1"),
                ({"SegmentSequence": segments[:1]}, "segment 2, which is not described"),
                ({"NumberOfFrames": 100000}, "NumberOfFrames"),
                ({"PixelData": b"\1\0"}, "truncated"),
                ({"FrameOfReferenceUID": "1.2.3"}, "another frame of reference"),
                ({"PatientID": "somebody-else"}, "of another patient"))):
            write_seg(self.image, self.folder / f"bad{n}.dcm", **changes)
            self.expect_refused(f"bad{n}.dcm", why, where="labels" if "another" in why else None)

    def test_damaged_files_are_read_or_refused(self):
        frames = write_seg(self.image, self.folder / "whole.dcm")
        self.expect_no_crash("whole.dcm", 12)
        rewritten(self.folder / "whole.dcm", pydicom.uid.RLELossless, [run_lengths(plane) for plane in fractional(frames, 255)],
                  **EIGHT_BITS, SegmentationType="FRACTIONAL", SegmentationFractionalType="OCCUPANCY", MaximumFractionalValue=255)
        self.expect_no_crash("whole.dcm", 12)

    def expect_no_crash(self, file, times):
        whole = (self.folder / file).read_bytes()
        head = len(whole) - len(pydicom.dcmread(self.folder / file).PixelData)
        random = numpy.random.default_rng(27)
        codes = set()
        for _ in range(times):
            content = bytearray(whole)
            for at in random.integers(132, head + 2000, 6):
                content[at] = random.integers(256)
            (self.folder / "damaged.dcm").write_bytes(content[:random.integers(head, len(content))] if random.integers(3) == 0 else content)
            codes.add(self.plan("damaged.dcm").returncode)
        self.assertLessEqual(codes, {0, 2, 3})


if __name__ == "__main__":
    unittest.main()
