"""What is kept of a campaign for the documentation. Inputs: entries by hand, with the fields that docs/reference/commands.md names."""

import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys
import unittest

PROGRAM = pathlib.Path(__file__).with_name("keep_campaign")


def program():
    loader = importlib.machinery.SourceFileLoader("keep_campaign", str(PROGRAM))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("keep_campaign", loader))
    loader.exec_module(module)
    return module


def entry(name, runs=10, beyond=0, worst=0.0, detected=None):
    return {"name": name, "runs": runs, "beyond": beyond, "worst_beyond_target_mm": worst, "detected_by": detected or {}}


class KeepCampaign(unittest.TestCase):
    def test_a_row_for_each_kind_of_each_signal_and_one_for_all(self):
        rows = program().rows_of([
            entry("depth frozen", 299, 0, -0.5, {"H-09 x": 200, "H-10 y": 99}),
            entry("depth frozen, noise 0.01 mm", 299, 2, 2.125, {"H-09 x": 1}),
            entry("voltage_monitor command, drive scale 1.5", 1000, 0, 1.68),
            entry("drive frozen", 2, 1, 3.0)])
        self.assertEqual(rows, [["depth frozen", "2", "598", "2", "+2.12", "50"],
                                ["voltage monitor command", "1", "1,000", "0", "+1.68", "0"],
                                ["drive frozen", "1", "2", "1", "+3.00", "0"], ["all", "4", "1,600", "3", "+3.00", "19"]])

    def test_what_is_no_whole_campaign_is_refused(self):
        for path in ("/dev/null", "/nowhere/campaign.json", str(PROGRAM)):
            done = subprocess.run([sys.executable, "-B", PROGRAM, path, "a command"], capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 2)
            self.assertIn(f"error: {path}: ", done.stderr)


if __name__ == "__main__":
    unittest.main()
