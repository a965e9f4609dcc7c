"""The Python package. Inputs: the example data set, whose generator shares no code with the product; images of nibabel;
voltages by hand; and what the command line answers to the same question.

usage: biopsy_test.py SOURCE_TREE BIOPSY
"""

import ast
import inspect
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import biopsy

SOURCE, PROGRAM = pathlib.Path(sys.argv[1]), sys.argv[2]
EXAMPLE = SOURCE / "docs/examples/gap"


def example_runs(roles=("", "", "")):
    runs = []
    for (name, grams), role in zip([("ramp-50g", 50), ("staircase-20g", 20), ("dc-80g", 80)], roles):
        table = np.genfromtxt(EXAMPLE / f"{name}.csv", delimiter=",", names=True)
        runs.append(biopsy.Run(table["voltage_V"], table["displacement_mm"], period_s=0.01, weight_g=grams, name=name, role=role))
    return runs


def answer(*arguments):
    """What the command line says, as JSON."""
    done = subprocess.run([PROGRAM, *map(str, arguments), "--json"], capture_output=True, text=True, check=True, cwd=SOURCE)
    return json.loads(done.stdout)


class Gap(unittest.TestCase):
    def test_finds_what_the_command_finds(self):
        with tempfile.TemporaryDirectory() as out:
            said = answer("gap", EXAMPLE, "--model", EXAMPLE / "stage.toml", "--no-recheck", "--out", f"{out}/gap")
        found = biopsy.gap(biopsy.read_model(EXAMPLE / "stage.toml"), example_runs(), sensor_noise_mm=0.01)
        self.assertEqual(found.verdict, said["verdict"])
        self.assertEqual(found.effects, [effect["name"] for effect in said["effects"]])
        self.assertAlmostEqual(found.rmse_after_mm, said["rmse_mm"]["after"], 6)
        before, force, std = found.changed["coulomb_friction.force_N"]
        self.assertIsNone(before)
        self.assertLess(abs(force - 0.05), 3 * std + 0.001)

    def test_gives_the_better_model_back_for_the_next_question(self):
        model = biopsy.read_model(EXAMPLE / "stage.toml")
        found = biopsy.gap(model, example_runs(), sensor_noise_mm=0.01)
        again = biopsy.Model.parse(found.model.text())
        run = example_runs()[0]
        before, after = (biopsy.simulate(m, run).displacement_mm - run.displacement_mm for m in (model, again))
        self.assertLess(np.std(after), 0.3 * np.std(before))
        self.assertEqual(biopsy.gap(again, example_runs(), sensor_noise_mm=0.01).verdict, "no_gap")

    def test_says_how_far_it_is_and_what_is_raised_there_ends_it(self):
        shares = []

        def stop(share, doing):
            shares.append(share)
            raise RuntimeError("enough")

        with self.assertRaisesRegex(RuntimeError, "enough"):
            biopsy.gap(biopsy.read_model(EXAMPLE / "stage.toml"), example_runs(), progress=stop)
        self.assertTrue(shares)

    def test_signals_are_arrays_of_each_run(self):
        found = biopsy.gap(biopsy.read_model(EXAMPLE / "stage.toml"), example_runs(), sensor_noise_mm=0.01)
        self.assertEqual(set(found.signals), {"ramp-50g", "staircase-20g", "dc-80g"})
        signal = found.signals["ramp-50g"]
        self.assertEqual(len({len(values) for values in signal.values()}), 1)
        self.assertLess(np.std(signal["measured_mm"] - signal["after_mm"]), np.std(signal["measured_mm"] - signal["before_mm"]))


class Plant(unittest.TestCase):
    def test_simulates_as_the_command_does(self):
        model = SOURCE / "sim/models/baseline.toml"
        said = answer("simulate", EXAMPLE, "--model", model, "--out", tempfile.mkdtemp() + "/out")
        for run, row in zip(example_runs(), said["runs"]):
            simulated = biopsy.simulate(biopsy.read_model(model), run)
            rms = np.sqrt(np.mean((simulated.displacement_mm - run.displacement_mm) ** 2))
            self.assertAlmostEqual(rms, row["rms_mm"], 9)

    def test_rises_with_the_square_of_the_voltage_and_not_with_its_sign(self):
        model = biopsy.read_model(SOURCE / "sim/models/baseline.toml")
        rest = [biopsy.simulate(model, biopsy.Run(np.full(2000, volts), weight_g=20)).displacement_mm[100]
                for volts in (1000.0, -1000.0, 2000.0)]
        self.assertAlmostEqual(rest[0], rest[1], 9)
        self.assertGreater(rest[2], rest[0])

    def test_refuses_what_cannot_be_a_record(self):
        good = np.zeros(10)
        for arguments, options, words in [
                ((good.reshape(2, 5),), {}, "input"), ((np.zeros(1),), {}, "input"),
                ((np.array([0.0, np.nan]),), {}, "value 1 is not a finite"), ((good, np.zeros(9)), {}, "9 values where there are 10"),
                ((good,), {"period_s": 0.0}, "period_s"), ((good,), {"period_s": 1.0}, "period_s"),
                ((good,), {"weight_g": -1}, "weight_g"), ((good,), {"role": "judge"}, "role"),
                ((good,), {"current_uA": [np.inf] * 10}, "current_uA")]:
            with self.assertRaises(biopsy.InputError) as raised:
                biopsy.Run(*arguments, **options)
            self.assertIn(words, str(raised.exception))
            self.assertTrue(raised.exception.where and raised.exception.remedy)
        for given, words in [(np.ma.masked_greater(np.arange(5.0), 3), "masked"), (good + 2j, "real numbers"), (["1", "2"], "real numbers"),
                             ([object()] * 3, "real numbers"), ([[1, 2], [3]], "real numbers"), (None, "real numbers")]:
            with self.assertRaisesRegex(biopsy.InputError, words):
                biopsy.Run(given)
        with self.assertRaises(biopsy.InputError):
            biopsy.Model.parse("K = 'high'")
        with self.assertRaises(biopsy.InputError):
            biopsy.gap(biopsy.read_model(), [])


    def test_takes_every_kind_of_real_array_as_it_is(self):
        given = np.arange(0, 96, 4)
        strided, reversed_, big = np.repeat(given, 3)[::3], given[::-1].copy()[::-1], given.astype(">f4")
        for array in (given, given.astype(np.float32), given.astype(np.uint8), strided, reversed_, big, given.tolist(),
                      np.ma.array(given)):
            np.testing.assert_array_equal(biopsy.Run(array).input, given)

    def test_windows_and_seeds_are_those_of_the_command_line(self):
        run = biopsy.Run(np.zeros(200), np.zeros(200), period_s=0.01)  # 2 s
        for window_s, words in [(0.0, "window_s"), (float("nan"), "window_s"), (2.5, "longer than run"), (0.015, "less than two rows")]:
            with self.assertRaisesRegex(biopsy.InputError, words):
                biopsy.gap(biopsy.read_model(), [run], window_s=window_s)
        for seed in (-3, 1e16, 2.5, float("inf")):
            with self.assertRaisesRegex(biopsy.InputError, "seed"):
                biopsy.Robot("gap", seed=seed)
            with self.assertRaisesRegex(biopsy.InputError, "seed"):
                biopsy.rehearse("gap", seed=seed)


class Images(unittest.TestCase):
    def test_have_the_place_that_nibabel_gives_them(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("no nibabel here")
        path = pathlib.Path(nibabel.__file__).parent / "tests/data/anatomical.nii"
        theirs, ours = nibabel.load(path), biopsy.read_image(path)
        np.testing.assert_allclose(ours.affine, theirs.affine, atol=1e-4)
        np.testing.assert_allclose(ours.voxels, theirs.get_fdata().T, rtol=1e-6)
        again = biopsy.Image(theirs.get_fdata().T, theirs.affine)
        np.testing.assert_allclose(again.affine, theirs.affine, atol=1e-12)

    def test_depth_is_read_of_a_needle_that_numpy_put_in(self):
        random = np.random.default_rng(5)
        k, j, i = np.mgrid[0:40, 0:64, 0:64]
        tissue = (200 + 40 * np.sin(i / 5.0) * np.cos(j / 7.0) + 30 * np.sin(k / 4.0) + 25 * np.cos((i + 2 * j) / 6.0))
        affine = np.diag([1.0, 1.0, 1.0, 1.0])  # 1 mm, RAS
        entry, axis, depth = np.array([32.0, 12.0, 20.0]), np.array([0.0, 1.0, 0.0]), 22.0
        along = (np.stack([i, j, k], -1) - entry) @ axis
        beside = np.linalg.norm(np.stack([i, j, k], -1) - entry - along[..., None] * axis, axis=-1)
        needle = (beside < 1.6) & (along < depth)
        before = biopsy.Image(tissue + random.normal(0, 3, tissue.shape), affine)
        after = biopsy.Image(np.where(needle, 10, tissue) + random.normal(0, 3, tissue.shape), affine)
        check = biopsy.check_depth(before, [after], entry, 5 * axis, expected_mm=depth, tip_offset_mm=0.0)
        self.assertTrue(check.tip_found)
        self.assertLess(abs(check.depth_mm - depth), 1.0)
        self.assertEqual(check.verdict, "accept", check.reason)
        self.assertEqual(biopsy.check_depth(before, [after], entry, axis, expected_mm=depth - 8, tip_offset_mm=0.0).verdict, "reject")
        self.assertNotEqual(biopsy.check_depth(before, [after], entry, axis, expected_mm=depth).verdict, "accept",
                            "without a tip offset nothing is accepted")

    def test_refuses_what_has_no_place(self):
        for voxels, affine in [(np.zeros((4, 4)), np.eye(4)), (np.zeros((4, 4, 4)), np.zeros((4, 4))),
                               (np.full((4, 4, 4), np.nan), np.eye(4)), (np.zeros((0, 4, 4)), np.eye(4)),
                               (np.zeros((4, 4, 4)), np.array([[1, 0.3, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]))]:
            with self.assertRaises(biopsy.InputError):
                biopsy.Image(voxels, affine)
        with self.assertRaises(biopsy.InputError):
            biopsy.read_image("/nowhere/image.nii")
        for voxels, affine, words in [(np.zeros((4, 4, 4)), np.eye(3), "4 x 4"), (np.zeros((4, 4, 4), complex), np.eye(4), "real"),
                                      (np.ma.masked_less(np.zeros((4, 4, 4)), 1), np.eye(4), "masked")]:
            with self.assertRaisesRegex(biopsy.InputError, words):
                biopsy.Image(voxels, affine)
        image = biopsy.Image(np.zeros((4, 4, 4)), np.eye(4))
        for entry, axis in [([1, 2], [0, 0, 1]), ([[1, 2, 3]], [0, 0, 1]), ([1, 2, 3], "up"), (np.zeros(4), [0, 0, 1])]:
            with self.assertRaises(biopsy.InputError):
                biopsy.check_depth(image, [image], entry, axis)


class Procedures(unittest.TestCase):
    def test_rehearse_as_the_command_does(self):
        with tempfile.TemporaryDirectory() as out:
            said = answer("dry-run", "gap", "--seed", 4, "--out", f"{out}/run")
        run = biopsy.rehearse("gap", seed=4)
        self.assertEqual(run.outcome, said["outcome"])
        self.assertAlmostEqual(run.true_depth_max_mm, said["true_depth_max_mm"], 3)
        self.assertEqual(len(run.time_s), len(run.depth_mm))
        self.assertEqual(len(run.mode), len(run.tip_mm))

    def test_faults_are_put_in_and_found(self):
        fault = '[[fault]]\nsignal = "depth"\nkind = "frozen"\nfrom_depth_mm = 1.0\n'
        run = biopsy.rehearse("gap", seed=2, faults=fault)
        self.assertEqual(run.outcome, "stopped")
        self.assertIsNotNone(run.faults[0]["detected_by"])
        with self.assertRaises(biopsy.InputError):
            biopsy.rehearse("gap", faults="[[fault]]\nsignal = 'moon'\n")

    def test_plan_is_staged(self):
        plan = biopsy.plan("liver")
        self.assertGreater(len(plan["steps"]), 1)
        self.assertEqual(plan["steps"][-1]["depth_mm"], plan["target_depth_mm"])
        self.assertGreaterEqual(plan["depth_max_mm"], plan["target_depth_mm"])


class UnderTheSupervisor(unittest.TestCase):
    def drive(self, asked_V, ticks=4000, **options):
        robot = biopsy.Robot("gap")
        seen = [robot.tick(arm=600 < t < 700, held=t > 900, voltage_V=asked_V(t), **options) for t in range(ticks)]
        return robot, seen

    def test_no_controller_gets_more_than_is_permitted(self):
        for asked in (1e5, -1e5, 2e4):
            _, seen = self.drive(lambda t, asked=asked: asked)
            self.assertTrue(all(abs(s["drive_V"]) <= s["v_max_V"] + 1e-9 for s in seen))

    def test_a_controller_that_runs_away_is_stopped(self):
        robot, seen = self.drive(lambda t: 8000 if t % 500 < 250 else -8000, ticks=12_000)
        self.assertLess(max(s["tip_mm"] for s in seen), robot.steps[-1]["depth_mm"] + 2.0)
        self.assertIn(seen[-1]["mode"], ("trip", "lock", "hold", "safe", "retract"))

    def test_without_the_key_nothing_is_put_out(self):
        robot = biopsy.Robot("gap")
        seen = [robot.tick(held=t > 900, voltage_V=3000.0) for t in range(3000)]
        self.assertEqual({s["drive_V"] for s in seen}, {0.0})

    def test_stop_takes_the_voltage_away(self):
        robot, seen = self.drive(lambda t: 2500 if t % 500 < 250 else -2500, ticks=2500)
        self.assertGreater(abs(seen[-1]["drive_V"]), 0)
        after = [robot.tick(stop="off", voltage_V=2500) for _ in range(10)]
        self.assertEqual(after[-1]["drive_V"], 0.0)
        with self.assertRaises(biopsy.InputError):
            robot.tick(stop="please")
        with self.assertRaises(biopsy.InputError):
            robot.tick(voltage_V=float("nan"))


class Package(unittest.TestCase):
    def test_the_type_stub_names_what_there_is(self):
        stub = ast.parse((SOURCE / "robot/python/biopsy/__init__.pyi").read_text())
        declared = {}
        for node in stub.body:
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                members = {n.name for n in getattr(node, "body", []) if isinstance(n, ast.FunctionDef)}
                declared[node.name] = members if isinstance(node, ast.ClassDef) else None
        self.assertEqual(set(declared), set(biopsy.__all__) - {"__version__"})
        for name, members in declared.items():
            thing = getattr(biopsy, name)
            self.assertTrue(inspect.getdoc(thing), f"{name} has no docstring")
            if members is None or name == "InputError":
                continue
            for member in members - {"__init__", "__len__"}:
                self.assertTrue(inspect.getdoc(vars(thing)[member]), f"{name}.{member} has no docstring")
            there = {m for m in vars(thing) if not m.startswith("_") or m in ("__init__", "__len__") and m in members}
            self.assertEqual(members, there, name)

    def test_the_examples_do_what_they_say(self):
        def said(name):
            return subprocess.run([sys.executable, SOURCE / "docs/examples/python" / name], capture_output=True, text=True,
                                  check=True, cwd=SOURCE).stdout
        lines = [line for line in (SOURCE / "docs/examples/python/laboratory.py").read_text().splitlines() if line.strip()]
        self.assertLessEqual(len(lines), 10)
        self.assertIn("Coulomb friction", said("laboratory.py"))
        self.assertIn("hold: needle at 2.", said("algorithm.py"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
