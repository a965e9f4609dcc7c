"""What counts as not judged. Inputs: results as ctest writes them, by hand."""

import importlib.machinery
import importlib.util
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
from xml.etree import ElementTree

PROGRAM = pathlib.Path(__file__).with_name("not_judged")


def run(in_real_time, not_judged, others_skipped=0, said="not judged:\ntrial 1, this machine stood still"):
    """Exit code and what is printed, of so many tests in real time and 50 others."""
    tests = [{"name": f"Live.{n}", "properties": [{"name": "RUN_SERIAL", "value": True}]} for n in range(in_real_time)]
    tests += [{"name": f"Other.{n}", "properties": []} for n in range(50)]
    tests.append({"name": "Live.WasNotRun", "properties": [{"name": "RUN_SERIAL", "value": True}]})

    def case(name, skipped):
        if skipped:
            return f'<testcase name="{name}" status="notrun"><skipped message=""/><system-out>{said}</system-out></testcase>'
        return f'<testcase name="{name}" status="run"><system-out>not judged is a word</system-out></testcase>'

    cases = [case(f"Live.{n}", n < not_judged) for n in range(in_real_time)]
    cases += [case(f"Other.{n}", n < others_skipped) for n in range(50)]
    with tempfile.TemporaryDirectory() as folder:
        results, known = pathlib.Path(folder, "results.xml"), pathlib.Path(folder, "tests.json")
        results.write_text(f"<testsuite>{''.join(cases)}</testsuite>")
        known.write_text(json.dumps({"tests": tests}))
        done = subprocess.run([sys.executable, "-B", PROGRAM, known, results], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def program():
    loader = importlib.machinery.SourceFileLoader("not_judged", str(PROGRAM))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("not_judged", loader))
    loader.exec_module(module)
    return module


def not_judged_of(results, tests):
    """Exit code, and the names that are printed, of several result files."""
    with tempfile.TemporaryDirectory() as folder:
        known = pathlib.Path(folder, "tests.json")
        known.write_text(json.dumps(tests))
        paths = [pathlib.Path(folder, f"{n}.xml") for n in range(len(results))]
        for path, text in zip(paths, results):
            path.write_text(text)
        done = subprocess.run([sys.executable, "-B", PROGRAM, known, *paths], capture_output=True, text=True, check=False)
    told = [line.removeprefix("not judged: ") for line in done.stdout.splitlines() if line.startswith("not judged: ")]
    return done.returncode, told


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

    def test_the_last_result_of_a_test_that_was_repeated_counts(self):
        names = ['Cases/Live.Completes/liver  # GetParam() = ("liver", 2)', "Live.[a]*b", "Live.aab"]
        tests = {"tests": [{"name": name, "properties": [{"name": "RUN_SERIAL", "value": True}]} for name in names]}

        def results(not_judged):
            suite = ElementTree.Element("testsuite")
            for name, is_not_judged in not_judged.items():
                case = ElementTree.SubElement(suite, "testcase", name=name, status="notrun" if is_not_judged else "run")
                if is_not_judged:
                    ElementTree.SubElement(case, "skipped")
                    ElementTree.SubElement(case, "system-out").text = "not judged:"
            return ElementTree.tostring(suite, encoding="unicode")

        first = results({names[0]: True, names[1]: True, names[2]: False})
        self.assertEqual(not_judged_of([first], tests), (3, names[:2]))
        self.assertEqual(not_judged_of([first, results({names[0]: False, names[1]: True})], tests), (3, [names[1]]))
        self.assertEqual(not_judged_of([first, results({names[0]: True}), results({names[0]: False, names[1]: False})], tests),
                         (0, []))

    def test_the_pattern_finds_the_names_and_no_others(self):
        names = ['Live.Completes/liver  # GetParam() = ("liver", 2)', "Live.[a]*b", "Live.a+$", r"Live.back\slash|or"]
        expression = re.compile(program().pattern(names))
        for name in names:
            self.assertTrue(expression.search(name))
        for other in ["Live.aab", "Live.aa", "Live.Completes/liver", "A" + names[1], names[1] + "c"]:
            self.assertFalse(expression.search(other))

    def test_only_what_asserts_no_deadline_is_repeated_with_a_slow_clock(self):
        bears = program().BEARS_A_SLOW_CLOCK
        for name in ["LiveRobot.TheNetworkCannotArm", "Cases/LiveProcedureMatrix.Completes/gap", "SecondWriter.Trips<Plan>"]:
            self.assertTrue(bears.match(name), name)
        for name in ["EveryProcess/LiveEventTest.TakesTheHighVoltageOff/stageKilled", "Console.Browser.procedure",
                     "Some/LostPacketsLiveEventTest.TakeTheHighVoltageOff/50InAThousand", "LiveNavigation.HostileClients",
                     "Some/TroubledPacketsLiveEventTest.LeaveTheRobot/late_10"]:
            self.assertFalse(bears.match(name), name)

    def test_without_tests_in_real_time_there_is_nothing_to_judge(self):
        self.assertEqual(run(0, 0)[0], 0)


if __name__ == "__main__":
    unittest.main()
