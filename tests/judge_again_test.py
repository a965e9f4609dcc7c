"""Which tests of an evidence file are run again, and what becomes of them. Inputs: a program that answers as a list says, in the
JSON that gtest 1.12 writes."""

import json
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

PROGRAM = pathlib.Path(__file__).with_name("judge_again")

# Answers the n-th call with the n-th word of results.txt.
FAKE = """\
#!/usr/bin/env python3
import json, pathlib, sys
here = pathlib.Path(__file__).parent
results = (here / "results.txt").read_text().split()
calls = here / "calls.txt"
number = len(calls.read_text().splitlines()) if calls.exists() else 0
name = sys.argv[1].removeprefix("--gtest_filter=")
with calls.open("a") as file:
    file.write(f"{name}\\n")
suite, test = name.split(".", 1)
entry = {"name": test, "status": "RUN", "result": "SKIPPED", "verifies": "R-26,R-44"}
if results[number] != "skipped":
    entry["result"] = "COMPLETED"
if results[number] == "failed":
    entry["failures"] = [{"failure": "late"}]
if results[number] != "died":
    pathlib.Path(sys.argv[2].removeprefix("--gtest_output=json:")).write_text(
        json.dumps({"testsuites": [{"testsuite": [entry]}]}))
print("said", results[number])
"""


class Evidence:
    def __init__(self, tests, results):
        """`tests`: name -> passed, skipped or failed, as they first were."""
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        program = self.path / "program"
        program.write_text(textwrap.dedent(FAKE))
        program.chmod(0o755)
        (self.path / "results.txt").write_text(" ".join(results))
        (self.path / "live.txt").write_text(
            "".join(f"[  SKIPPED ] {name} (39779 ms)\n" for name, was in tests.items() if was == "skipped"))
        failed = [was for was in tests.values() if was != "passed"]
        self.before = {"passed": not failed, "figures": {"failed": float(len(failed)), "tests": float(len(tests))},
                       "tests": [{"name": name, "passed": was == "passed", "verifies": []} for name, was in tests.items()]}
        (self.path / "live.json").write_text(json.dumps(self.before))
        self.code = subprocess.run([sys.executable, "-B", PROGRAM, self.path / "live.json", program],
                                   capture_output=True, text=True, check=False).returncode
        self.after = json.loads((self.path / "live.json").read_text())
        calls = self.path / "calls.txt"
        self.calls = calls.read_text().splitlines() if calls.exists() else []
        self.log = (self.path / "live.txt").read_text()
        self.folder.cleanup()


class JudgeAgain(unittest.TestCase):
    def test_what_was_skipped_counts_as_it_ends_when_it_is_judged(self):
        done = Evidence({"A.One": "passed", "A.Two/doubled_1000": "skipped"}, ["skipped", "skipped", "passed"])
        self.assertEqual(done.code, 0)
        self.assertEqual(done.calls, ["A.Two/doubled_1000"] * 3)
        self.assertEqual(done.after["tests"][1], {"name": "A.Two/doubled_1000", "passed": True, "verifies": ["R-26", "R-44"]})
        self.assertEqual((done.after["passed"], done.after["figures"]), (True, {"failed": 0.0, "tests": 2.0}))
        self.assertEqual(done.log.count("run again, alone\nsaid"), 3)

    def test_a_failure_in_the_repetition_is_one(self):
        for result in ("failed", "died"):
            done = Evidence({"A.One": "skipped"}, [result])
            self.assertEqual((done.code, len(done.calls)), (0, 1))
            self.assertEqual((done.after["passed"], done.after["figures"]["failed"]), (False, 1.0))

    def test_what_is_never_judged_stays_not_passed(self):
        done = Evidence({"A.One": "skipped"}, ["skipped"] * 9)
        self.assertEqual(len(done.calls), 5)
        self.assertFalse(done.after["passed"] or done.after["tests"][0]["passed"])

    def test_what_failed_is_not_run_again(self):
        done = Evidence({"A.One": "failed", "A.Two": "passed"}, ["passed"])
        self.assertEqual((done.code, done.calls, done.after), (1, [], done.before))
        beside = Evidence({"A.One": "failed", "A.Two": "skipped"}, ["passed"])
        self.assertEqual((beside.code, beside.calls), (0, ["A.Two"]))
        self.assertEqual((beside.after["passed"], beside.after["figures"]["failed"]), (False, 1.0))


if __name__ == "__main__":
    unittest.main()
