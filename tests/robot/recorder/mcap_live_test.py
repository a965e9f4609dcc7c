"""Live runs as MCAP files, read by @mcap/core: the recording of the bus, of a recorder that is stopped and of one that is
killed, and the layout of docs/examples over an exported log. mcap_live_test.py BIOPSY FOLDER_OF_READER LAYOUT"""

import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

BIOPSY, READER, LAYOUT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
del sys.argv[1:]
if not (READER / "node_modules").exists():
    print("skipped: @mcap/core is not installed")
    sys.exit(77)
DOMAIN = 61  # of this test alone
CYCLIC = ("/Measurement", "/DriveRequest", "/Permit", "/Decision")


def node(script, *words):
    return subprocess.run(["node", script, *map(str, words)], cwd=READER, capture_output=True, text=True, timeout=120)


class Mcap(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)

    def tearDown(self):
        self.scratch.cleanup()

    def up(self, *words):
        return subprocess.Popen([BIOPSY, "up", "gap", "--without-security", "--domain", str(DOMAIN), "--out", "up", *words], cwd=self.folder,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def recovered(self, file):
        result = node("recover.mjs", file)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        answer = json.loads(result.stdout)
        self.assertEqual(answer["disorder"], [])
        return answer

    def recorded(self, name, seconds):
        """A run with --mcap until its file has been there for so long."""
        up, file = self.up("--mcap"), self.folder / "up" / name
        for _ in range(1200):  # starting may take a minute where the machine is busy
            if file.exists() or up.poll() is not None:
                break
            time.sleep(0.1)
        time.sleep(seconds)
        up.send_signal(signal.SIGINT)
        text = up.communicate(timeout=120)[0]
        self.assertEqual(up.returncode, 0, text)
        return self.recovered(file)

    def test_recording_of_the_bus_is_whole(self):
        found = self.recorded("bus.mcap", 4)
        self.assertTrue(found["whole"])
        for topic in (*CYCLIC, "/Health", "/LogHealth"):
            self.assertGreater(found["counts"].get(topic, 0), 3, found)
        for topic in CYCLIC:  # of a thousand a second at most a hundred, but for changes
            self.assertGreater(found["counts"][topic], 50, found)
            self.assertLess(found["counts"][topic], 1500, found)
        # A second run in the folder leaves the first one's recording.
        self.assertTrue(self.recorded("bus-2.mcap", 1)["whole"])
        self.assertTrue((self.folder / "up/bus.mcap").exists())

    def test_recorder_that_is_killed_leaves_all_but_the_last_second(self):
        up = self.up()
        lines = iter(up.stdout.readline, "")
        self.assertTrue(any(line.startswith("up: ") for line in lines))
        recorder = subprocess.Popen([BIOPSY.parent / "biopsy-mcap", "up"], cwd=self.folder, stdout=subprocess.PIPE, text=True)
        name = recorder.stdout.readline().strip()
        time.sleep(5)
        os.kill(recorder.pid, signal.SIGKILL)
        killed_ns = time.time_ns()
        recorder.wait(timeout=30)
        recorder.stdout.close()
        found = self.recovered(self.folder / name)
        self.assertFalse(found["whole"])
        self.assertGreater(found["counts"]["/Measurement"], 100, found)
        self.assertLess(killed_ns - int(found["last"]), 2e9)
        self.assertIsNone(up.poll(), "the robot goes on")
        up.send_signal(signal.SIGINT)
        text = up.communicate(timeout=120)[0]
        self.assertEqual(up.returncode, 0, text)

    def test_layout_leads_somewhere_in_an_exported_log(self):
        run = subprocess.run([BIOPSY, "dry-run", "gap", "--live", "--without-security", "--domain", str(DOMAIN), "--out", "live"], cwd=self.folder,
                             capture_output=True, text=True, timeout=240)
        self.assertIn(run.returncode, (0, 3), run.stdout + run.stderr)  # 3: stopped, where the machine is too busy for it
        export = subprocess.run([BIOPSY, "log", "export", "live/procedure.log.sqlite", "--mcap", "live.mcap", "--run", "live/run.csv"],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(export.returncode, 0, export.stderr)
        result = node("paths.mjs", LAYOUT, self.folder / "live.mcap")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
