"""What counts as not judged. Inputs: results as ctest writes them, by hand."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).with_name("not_judged")


def run(in_real_time, not_judged, others_skipped=0, said="not judged:\ntrial 1, this machine stood still",
        ran_and_said="not judged is a word"):
    """Exit code and what is printed, of so many tests in real time and 50 others."""
    tests = [{"name": f"Live.{n}", "properties": [{"name": "RUN_SERIAL", "value": True}]} for n in range(in_real_time)]
    tests += [{"name": f"Other.{n}", "properties": []} for n in range(50)]
    tests.append({"name": "Live.WasNotRun", "properties": [{"name": "RUN_SERIAL", "value": True}]})

    def case(name, skipped):
        if skipped:
            return f'<testcase name="{name}" status="notrun"><skipped message=""/><system-out>{said}</system-out></testcase>'
        return f'<testcase name="{name}" status="run"><system-out>{ran_and_said}</system-out></testcase>'

    cases = [case(f"Live.{n}", n < not_judged) for n in range(in_real_time)]
    cases += [case(f"Other.{n}", n < others_skipped) for n in range(50)]
    with tempfile.TemporaryDirectory() as folder:
        results, known = pathlib.Path(folder, "results.xml"), pathlib.Path(folder, "tests.json")
        results.write_text(f"<testsuite>{''.join(cases)}</testsuite>")
        known.write_text(json.dumps({"tests": tests}))
        done = subprocess.run([sys.executable, "-B", PROGRAM, known, results], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


class NotJudged(unittest.TestCase):
    def test_up_to_a_tenth_passes_and_is_counted(self):
        self.assertEqual(run(20, 0), (0, "tests in real time: 20, not judged: 0\n"))
        code, text = run(20, 2)
        self.assertEqual(code, 0)
        self.assertIn("not judged: Live.1\ntests in real time: 20, not judged: 2\n", text)

    def test_more_than_a_tenth_fails(self):
        self.assertEqual(run(20, 3)[0], 3)
        self.assertEqual(run(1, 1)[0], 3)
        self.assertEqual(run(9, 1)[0], 3)
        self.assertEqual(run(10, 1)[0], 0)

    def test_other_skipped_tests_do_not_count(self):
        self.assertEqual(run(20, 0, others_skipped=30)[0], 0)
        self.assertEqual(run(20, 5, said="needs a board")[0], 0)

    def test_what_a_slowed_clock_judged_is_named_and_counts(self):
        said = "not judged\njudged with a slowed clock"
        self.assertEqual(run(3, 0, ran_and_said=said), (0, "".join(
            f"judged with a slowed clock: Live.{n}\n" for n in range(3)) + "tests in real time: 3, not judged: 0\n"))
        self.assertEqual(run(3, 3, said=said)[0], 3)

    def test_without_tests_in_real_time_there_is_nothing_to_judge(self):
        self.assertEqual(run(0, 0)[0], 0)


if __name__ == "__main__":
    unittest.main()
