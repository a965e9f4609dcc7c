"""A navigation program that has nothing of the product in it: messages put together and taken apart with struct, by the descriptions
of OpenIGTLink's protocol (versions 2 and 3) and of the MRI robots' messages, against biopsy-igtl as a process. No robot is up, so
that motion is always refused; what needs one is in the live tests. peer_test.py BIOPSY BIOPSY_IGTL"""

import itertools
import math
import pathlib
import random
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

BIOPSY_IGTL, BIOPSY = sys.argv.pop(), sys.argv.pop()
COMMANDS = ["START_UP", "PLANNING", "CALIBRATION", "TARGETING", "MOVE_TO_TARGET", "MANUAL", "STOP", "EMERGENCY"]
OTHER_TYPES = ["POSITION", "QTDATA", "QTRANS", "SENSOR", "NDARRAY", "TDATA", "POLYDATA", "POINT", "TRAJ", "IMGMETA", "LBMETA", "COLORT",
               "BIND", "COMMAND", "RTS_COMMAND", "CAPABILITY", "GET_CAPABIL", "GET_IMAGE", "STT_TDATA", "STP_TDATA", "VIDEO", "", "OWN"]
SCALARS = {2: "b", 3: "B", 4: "h", 5: "H", 6: "i", 10: "f"}
NRRD_TYPES = {2: "int8", 3: "uint8", 4: "int16", 5: "uint16", 6: "int32", 10: "float"}


def crc64(data):
    crc = 0
    for byte in data:
        crc ^= byte << 56
        for _ in range(8):
            crc = (crc << 1 ^ (0x42F0E1EBA9EA3693 if crc >> 63 else 0)) & (1 << 64) - 1
    return crc


def message(kind, device, content=b"", version=1):
    if version == 2:  # extended header; metadata behind the content: one pair of texts
        pair = struct.pack(">HHHI", 1, 4, 3, 5) + b"name" + b"value"
        content = struct.pack(">HHII", 12, 10, len(pair) - 10, 1) + content + pair
    name = lambda text, count: text.encode().ljust(count, b"\0")
    return struct.pack(">H", version) + name(kind, 12) + name(device, 20) + struct.pack(">QQQ", 0, len(content), crc64(content)) + content


def string(device, text, encoding=3, **more):
    return message("STRING", device, struct.pack(">HH", encoding, len(text)) + text.encode(), **more)


def transform(device, origin=(0, 0, 0), columns=((1, 0, 0), (0, 1, 0), (0, 0, 1)), **more):
    return message("TRANSFORM", device, struct.pack(">12f", *itertools.chain(*columns, origin)), **more)


def image(device, scalar=4, big=True, ras=True, size=(3, 2, 2), values=None, axes=((1, 0, 0), (0, 1, 0), (0, 0, 1)), centre=(0, 0, 0),
          components=1, part=None, **more):
    values = list(range(math.prod(size))) if values is None else values
    offset, subsize = part or ((0, 0, 0), size)
    head = struct.pack(">HBBBB3H", 1, components, scalar, 1 if big else 2, 1 if ras else 2, *size)
    head += struct.pack(">12f", *itertools.chain(*axes, centre)) + struct.pack(">6H", *offset, *subsize)
    return message("IMAGE", device, head + struct.pack(("<", ">")[big] + str(len(values)) + SCALARS.get(scalar, "H"), *values), **more)


class Robot:
    """biopsy-igtl on a port of its own."""

    def __init__(self, dialect):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        prepared = subprocess.run([BIOPSY, "up", "gap", "--prepare", "--without-security", "--domain", "101", "--out", self.folder / "run"],
                                  capture_output=True, text=True, timeout=120)
        assert prepared.returncode == 0, prepared.stderr
        (self.folder / "images").mkdir()
        self.process = subprocess.Popen([BIOPSY_IGTL, self.folder / "run", "--port", "0", "--dialect", dialect, "--images-to",
                                         self.folder / "images"], stdout=subprocess.PIPE, text=True)
        told = self.process.stdout.readline()
        self.port = int(re.search(r":([0-9]+)$", told.strip()).group(1))

    def end(self):
        self.process.terminate()
        assert self.process.wait(20) == 0
        self.process.stdout.close()
        self.scratch.cleanup()


class Client:
    def __init__(self, robot):
        self.socket = socket.create_connection(("127.0.0.1", robot.port), timeout=15)
        self.waiting = b""

    def send(self, data):
        self.socket.sendall(data)

    def take(self, count):
        while len(self.waiting) < count:
            more = self.socket.recv(65536)
            if not more:
                raise EOFError
            self.waiting += more
        taken, self.waiting = self.waiting[:count], self.waiting[count:]
        return taken

    def next(self):
        """(type, device, content) of the next message, whose header and CRC are right."""
        head = self.take(58)
        version, kind, device, _, size, crc = struct.unpack(">H12s20sQQQ", head)
        assert version == 1, version
        body = self.take(size)
        assert crc64(body) == crc
        kind, device = (field.split(b"\0")[0].decode() for field in (kind, device))
        if kind == "STRING":
            encoding, length = struct.unpack(">HH", body[:4])
            assert encoding == 3 and length == len(body) - 4
            return kind, device, body[4:].decode()
        if kind == "STATUS":
            code, _, name = struct.unpack(">Hq20s", body[:30])
            assert body[-1:] == b"\0"
            return kind, device, (code, name.split(b"\0")[0].decode(), body[30:-1].decode())
        assert kind == "TRANSFORM" and len(body) == 48, kind
        return kind, device, body

    def close(self):
        self.socket.close()


class Peer(unittest.TestCase):
    dialect = None

    @classmethod
    def setUpClass(cls):
        if cls.dialect is None:
            raise unittest.SkipTest("of both dialects below")
        cls.robot = Robot(cls.dialect)

    @classmethod
    def tearDownClass(cls):
        cls.robot.end()

    def setUp(self):
        self.client = Client(self.robot)
        self.addCleanup(self.client.close)

    def status(self, device, code, client=None):
        """The next message, a STATUS with a reason; its name and text."""
        kind, of, content = (client or self.client).next()
        self.assertEqual((kind, of, content[0] if kind == "STATUS" else content), ("STATUS", device, code), content)
        self.assertTrue(content[2], "without a reason")
        return content[1:]

    def command(self, text, number="7", **more):
        begun = time.monotonic()
        self.client.send(string("CMD_" + number, text, **more))
        self.assertEqual(self.client.next(), ("STRING", "ACK_" + number, text))
        self.assertLess(time.monotonic() - begun, 1.0)

    def entered(self, text, **more):
        self.command(text, **more)
        self.assertEqual(self.status("CURRENT_STATUS", 1)[0], text)

    def phase(self, text, **more):
        self.entered(text, **more)
        if self.dialect == "2021":
            self.status(text, 1)

    def place(self, device, *transform_arguments, **more):
        sent = transform(device, *transform_arguments, **more)
        self.client.send(sent)
        kind, of, content = self.client.next()
        self.assertEqual((kind, of), ("TRANSFORM", "ACK_" + device[4:]))
        self.assertEqual(content, sent[58:106] if more.get("version", 1) == 1 else sent[70:118])

    def calibrated(self):
        self.phase("CALIBRATION")
        self.place("CLB_1")
        self.status("CALIBRATION", 1)
        self.entered("TARGETING")
        self.status("TARGETING", 1)

    def test_every_command_is_acknowledged_and_its_status_named(self):
        for version in (1, 2):
            for text in ("PLANNING", "CALIBRATION"):
                self.phase(text, version=version, number="0123456789abcdef")
        for text in ("STOP", "MANUAL", "EMERGENCY"):
            self.entered(text)
            self.assertIn("emergency stop", self.status(text, 7)[1])  # nobody confirms it

    def test_a_robot_that_is_silent_is_not_ready(self):
        self.entered("START_UP")
        self.assertIn("silent", self.status("START_UP", 13)[1])
        self.entered("MOVE_TO_TARGET")
        self.assertIn("silent", self.status("MOVE_TO_TARGET", 13)[1])

    def test_calibrations_that_are_none_are_refused(self):
        self.phase("CALIBRATION")
        turn = math.radians(30)
        for version in (1, 2):
            self.place("CLB_1", (10, 20, 30), ((math.cos(turn), math.sin(turn), 0), (-math.sin(turn), math.cos(turn), 0), (0, 0, 1)),
                       version=version)
            self.status("CALIBRATION", 1)
        for origin, columns in (((0, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, -1))), ((0, 0, 0), ((2, 0, 0), (0, 2, 0), (0, 0, 2))),
                                ((0, 0, 0), ((1, 0, 0), (1, 0, 0), (0, 0, 1))), ((0, 0, 0), ((0, 0, 0), (0, 0, 0), (0, 0, 0))),
                                ((2500, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))), ((math.nan, 0, 0), ((1, 0, 0), (0, 1, 0), (0, 0, 1))),
                                ((0, 0, 0), ((math.inf, 0, 0), (0, 1, 0), (0, 0, 1)))):
            self.place("CLB_2", origin, columns)
            self.status("CALIBRATION", 10)

    def test_targets_that_cannot_be_reached_are_refused_with_the_distance(self):
        self.calibrated()
        for origin, told in (((5, 0, 3), "5.0 mm"), ((0, -3, 3), "3.0 mm"), ((3, 4, 3), "5.0 mm"), ((0, 0, -7), "7.0 mm"), ((0, 0, 500), "500.0 mm"),
                             ((math.nan, 0, 3), "not a number")):
            self.place("TGT_1", origin)
            self.assertIn(told, self.status("TARGET", 10)[1])
        beyond = re.search(r"([0-9.]+) mm deep, ([0-9.]+) mm beyond the reach of ([0-9.]+) mm", self.refused_target((0, 0, 500)))
        self.assertAlmostEqual(float(beyond[1]), float(beyond[2]) + float(beyond[3]), delta=0.06)

    def refused_target(self, origin):
        self.place("TGT_2", origin)
        return self.status("TARGET", 10)[1]

    def test_a_target_that_no_console_plans_is_told_in_time(self):
        self.calibrated()
        begun = time.monotonic()
        self.place("TGT_3", (0, 0, 3))
        self.status("TARGET", 7)
        self.assertLess(time.monotonic() - begun, 10)

    def test_order_is_kept_to(self):
        self.entered("PLANNING")
        if self.dialect == "2021":
            self.status("PLANNING", 1)
        self.place("CLB_1")
        self.status("CALIBRATION", 13)
        self.place("TGT_1", (0, 0, 3))
        self.status("TARGET", 13)

    def test_what_is_unknown_has_a_status_with_its_reason(self):
        for kind in OTHER_TYPES:
            self.client.send(message(kind, "device", b"\1\2\3"))
            self.status("CURRENT_STATUS", 12)
        for text in ("", "START", "start_up", "MOVE", "X" * 200):
            self.command(text)
            self.status("CURRENT_STATUS", 12)
        for unusable in (string("Other", "STOP"), transform("Tool"), message("STRING", "CMD_1", b"\0\3\0\x09STOP"),
                         message("TRANSFORM", "TGT_1", bytes(47)), message("STRING", "CMD_1", b""),
                         string("CMD_1", "PLANNING")[:50] + bytes(8) + string("CMD_1", "PLANNING")[58:]):
            self.client.send(unusable)
            self.status("CURRENT_STATUS", 12)
        self.client.send(string("CMD_1", "PLANNING", encoding=1))
        self.assertIn("US-ASCII", self.status("CURRENT_STATUS", 12)[1])

    def test_questions_are_answered(self):
        self.client.send(message("GET_STATUS", "any"))
        self.assertEqual(self.client.next()[:2], ("STATUS", "CURRENT_STATUS"))
        self.client.send(message("GET_TRANS", "CURRENT_POSITION"))
        self.status("CURRENT_POSITION", 13)
        self.client.send(string("CURRENT_POSITION", "CURRENT_POSITION"))
        self.status("CURRENT_POSITION" if self.dialect == "2021" else "CURRENT_STATUS", 13 if self.dialect == "2021" else 12)

    def test_a_byte_at_a_time_is_the_same(self):
        for byte in string("CMD_5", "PLANNING"):
            self.client.send(bytes([byte]))
        self.assertEqual(self.client.next(), ("STRING", "ACK_5", "PLANNING"))

    def stored(self, device, **given):
        self.client.send(image(device, **given))
        name = self.status(device, 1)[1]
        head, _, voxels = (self.robot.folder / "images" / name).read_bytes().partition(b"\n\n")
        fields = dict(line.split(": ", 1) for line in head.decode().splitlines()[1:])
        vectors = [[float(x) for x in one.split(",")] for one in re.findall(r"\(([^)]*)\)", fields["space directions"])]
        return fields, vectors, [float(x) for x in fields["space origin"].strip("()").split(",")], voxels

    def test_images_keep_their_values_and_their_place(self):
        turn = math.radians(20)
        axes = ((0.8 * math.cos(turn), 0.8 * math.sin(turn), 0), (-0.9 * math.sin(turn), 0.9 * math.cos(turn), 0), (0, 0, -2.5))
        centre, size = (11.5, -22.25, 33.125), (5, 4, 3)
        low = {2: -128, 4: -32768, 6: -2 ** 31, 10: -1.5}
        for scalar, big, ras, version in itertools.product(SCALARS, (True, False), (True, False), (1, 2)):
            values = [low.get(scalar, 0), *range(1, math.prod(size) - 1), 127]
            fields, vectors, origin, voxels = self.stored("scan", scalar=scalar, big=big, ras=ras, size=size, values=values, axes=axes,
                                                          centre=centre, version=version)
            self.assertEqual((fields["type"], fields["sizes"], fields["endian"]), (NRRD_TYPES[scalar], "5 4 3", "little"))
            self.assertEqual(fields["space"], "left-posterior-superior")
            self.assertEqual(list(struct.unpack("<60" + SCALARS[scalar], voxels)), values)
            turned = (-1, -1, 1) if ras else (1, 1, 1)
            for vector, axis in zip(vectors, axes):
                for found, wanted, sign in zip(vector, axis, turned):
                    self.assertAlmostEqual(found, sign * wanted, places=5)
            for n in range(3):  # centre of the first voxel
                first = centre[n] - sum((count - 1) / 2 * axis[n] for count, axis in zip(size, axes))
                self.assertAlmostEqual(origin[n], turned[n] * first, places=4)

    def test_images_that_cannot_be_used_are_refused(self):
        before = sorted((self.robot.folder / "images").iterdir())
        bad = [image("scan", components=3), image("scan", scalar=7), image("scan", scalar=11), image("scan", scalar=13), image("scan", values=[1, 2]),
               image("scan", size=(0, 2, 2), values=[]), image("scan", centre=(math.nan, 0, 0)), image("scan", axes=((math.inf, 0, 0), (0, 1, 0), (0, 0, 1))),
               image("scan", part=((1, 0, 0), (2, 2, 2))), message("IMAGE", "scan", bytes(71))]
        for byte in (4, 5):  # endianness and frame
            content = bytearray(image("scan")[58:])
            content[byte] = 9
            bad.append(message("IMAGE", "scan", bytes(content)))
        for one in bad:
            self.client.send(one)
            self.status("CURRENT_STATUS", 12)
        self.assertEqual(sorted((self.robot.folder / "images").iterdir()), before)

    def test_a_body_that_is_too_large_is_told_and_closed(self):
        for kind, size in (("IMAGE", 200_000_000), ("STRING", 80_000), ("STRING", 2 ** 63), ("IMAGE", 2 ** 64 - 1)):
            other = Client(self.robot)
            other.send(message(kind, "CMD_1")[:42] + struct.pack(">QQ", size, 0))
            self.assertIn(str(size), self.status("CURRENT_STATUS", 12, other)[1])
            self.assertRaises(EOFError, other.next)
            other.close()

    def test_damaged_messages_are_answered_or_closed_and_others_served(self):
        seeded = random.Random(27)
        good = [string("CMD_1", "PLANNING"), transform("CLB_1"), image("scan"), string("CMD_2", "TARGETING", version=2)]
        for _ in range(300):
            data = bytearray(seeded.choice(good))
            for _ in range(seeded.randint(1, 4)):
                data[seeded.randrange(len(data))] = seeded.randrange(256)
            other = Client(self.robot)
            other.send(bytes(data) + bytes(58))
            other.socket.shutdown(socket.SHUT_WR)
            answers = []
            try:
                while True:
                    answers.append(other.next())
            except (EOFError, ConnectionResetError):
                pass
            other.close()
        self.assertIsNone(self.robot.process.poll())
        self.client.send(message("GET_STATUS", "any"))
        self.assertEqual(self.client.next()[:2], ("STATUS", "CURRENT_STATUS"))


class Of2013(Peer):
    dialect = "2013"


class Of2021(Peer):
    dialect = "2021"


if __name__ == "__main__":
    unittest.main()
