#!/usr/bin/python3
"""Kills mutants of the safety core, or of another room: runs, for each, the tests that reach it until one fails.

Exit 0: every mutant is dead, proven equivalent or explained, the canary died, the unmutated copy passes all tests.
Exit 3: one of these does not hold. Exit 2: wrong usage.
"""

import argparse
import json
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

QUICK_ONE_IN, QUICK_SEED = 12, 6
WALKS = ("reachable steps", "reachable gates")  # a minute each: one walk for all that are compared with it
MEMORY = "/dev/shm"  # where tests that wait for the disk do not wait
NEAR_LINES = 2  # mutants so near to each other often die of the same test,
NEAR_WEIGHT = 25  # which is tried before others that would take more than a 25th of its time


class Killers:
    """A running program `killers`: one mutant after the other in it, each in a process of its own."""

    def __init__(self, program, mutant=0):
        self.scratch = Path(tempfile.mkdtemp())
        self.scratch.chmod(0o755)  # a test may go on as another user
        environment = {**os.environ, "MUTANT": str(mutant), "TMPDIR": str(self.scratch)}
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        stderr=subprocess.DEVNULL, env=environment)

    def first_to_fail(self, mutant, tests):
        """Name of the test that kills, "-" if all pass, "start" if it dies before the first one."""
        order = " ".join(f"{round(200 + 10 * test['ms'])} {test['name']}" for test in tests)
        try:
            print(mutant, order, file=self.process.stdin, flush=True)
            return self.process.stdout.readline().strip() or "start"
        except BrokenPipeError:
            return "start"
        finally:
            for left in self.scratch.iterdir():  # by a test that did not come to its end
                shutil.rmtree(left, ignore_errors=True)

    def end(self):
        try:
            self.process.stdin.close()
        except BrokenPipeError:
            pass
        self.process.stdout.close()
        self.process.wait()


class Mill:
    """What was built, and what the tests reach in it."""

    def __init__(self, build):
        self.build = build
        self.mutants = json.loads((build / "mutants.json").read_text())
        reach = json.loads(self.run(-1, "killers", "--reach").stdout)
        self.slow = [test["name"] for test in reach["tests"] if not test["in_time"]]  # left out
        in_time = [test for test in reach["tests"] if test["in_time"]]
        self.failing = [test["name"] for test in in_time if not test["passed"]]  # they prove nothing
        self.tests = sorted((test for test in in_time if test["passed"]), key=lambda test: test["ms"])
        self.before_main = set(reach["before_main"])
        for test in self.tests:
            test["reached"] = set(test["reached"])
        self.relations = {}
        self.killed_at = {}  # file, line -> names of the tests that killed mutants there
        self.of_thread = threading.local()

    def run(self, mutant, program, *arguments):
        environment = {**os.environ, "MUTANT": str(mutant)}
        return subprocess.run([str(self.build / program), *arguments], env=environment, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, check=False)

    def in_order(self, mutant, tests):
        """The tests as they are tried: the fastest first, and early what killed its neighbours."""
        near = set()
        for line in range(mutant["line"] - NEAR_LINES, mutant["line"] + NEAR_LINES + 1):
            near |= self.killed_at.get((mutant["file"], line), frozenset())
        return sorted(tests, key=lambda test: test["ms"] * (1 if test["name"] in near else NEAR_WEIGHT))

    def killer_of(self, mutant):
        """Name of the test that kills it, None if it survives."""
        killer = self.first_killer(mutant)
        if killer is not None:
            place = mutant["file"], mutant["line"]
            self.killed_at[place] = self.killed_at.get(place, frozenset()) | {killer}
        return killer

    def first_killer(self, mutant):
        number = mutant["id"]
        if number in self.before_main:  # it is in tables that are filled when a program starts
            killers = Killers(self.build / "killers", number)
            killer = killers.first_to_fail(number, self.in_order(mutant, self.tests))
            killers.end()
        else:
            if not hasattr(self.of_thread, "killers"):
                self.of_thread.killers = Killers(self.build / "killers")
            reaching = [test for test in self.tests if number in test["reached"]]
            killer = self.of_thread.killers.first_to_fail(number, self.in_order(mutant, reaching))
        return None if killer == "-" else killer

    def relation(self, number, name):
        """Hash of all pairs of input and output that the program `relations` knows under this name."""
        done = self.run(number, "relations", name)
        return done.stdout if done.returncode == 0 else None

    def walk(self, name, suspects):
        """The hash of a relation by walking what is reachable, and those of the suspects that did the same at each step."""
        done = self.run(0, "relations", name, *map(str, suspects))
        first, *alike = done.stdout.split("\n") if done.returncode == 0 else [None]
        return first, {int(number) for number in alike if number}

    def is_same_relation(self, mutant, name):
        known = self.relations[name].result()
        if name not in WALKS:
            return known is not None and self.relation(mutant["id"], name) == known
        first, alike = known
        if mutant["id"] in self.before_main:  # it takes the walk alone
            return first is not None and self.relation(mutant["id"], name) == first + "\n"
        return mutant["id"] in alike

    def start_relations(self, pool, mutants, equivalents):
        """Begins what mutants claimed equivalent are compared with: mutants of tables go alone, the others side by side."""
        claims = [(mutant["id"], name) for mutant in mutants for name in equivalents.get(key_of(mutant), ("", []))[1]]
        for name in sorted({name for _, name in claims}, key=lambda name: name not in WALKS):
            suspects = [number for number, of in claims if of == name and number not in self.before_main]
            task = (self.walk, name, suspects) if name in WALKS else (self.relation, 0, name)
            self.relations[name] = pool.submit(*task)


def key_of(mutant):
    return mutant["file"], mutant["text"], mutant["operator"], mutant["change"]


def place_of(row):
    return f"{row['file']}:{row['line']}: {row['operator']}: {row['change']}"


def read_equivalents(file):
    """Key of each mutant in the file -> (reason, relations that prove it; none: the reason alone explains a survivor)."""
    entries = {}
    for group in tomllib.loads(file.read_text()).get("equivalent", []):
        for file, text, operator, change in group["mutants"]:
            entries[file, text, operator, change] = group["reason"], group["proof"]
    return entries


def judge(mill, mutants, equivalents, verdicts):
    """Fills verdicts: id -> (verdict, name of the test or reason)."""
    def one(mutant):
        reason, relations = equivalents.get(key_of(mutant), ("", []))
        if relations and all(mill.is_same_relation(mutant, name) for name in relations):
            return "equivalent", reason
        killer = mill.killer_of(mutant)  # also where a line of the same text has the equivalent one
        if killer is None and reason and not relations:
            return "explained", reason
        if killer is None:
            return "survivor", "claimed equivalent, but its relation differs" if relations else ""
        return "killed", killer

    # Those that wait for a walk come last: meanwhile the others keep the processors busy.
    mutants = sorted(mutants, key=lambda mutant: key_of(mutant) in equivalents)
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        mill.start_relations(pool, mutants, equivalents)
        for done, (mutant, verdict) in enumerate(zip(mutants, pool.map(one, mutants)), 1):
            verdicts[mutant["id"]] = verdict
            if done % 200 == 0:
                print(f"{done} of {len(mutants)} mutants", file=sys.stderr)


def tables_of(mutants, verdicts, stale, slow):
    def rows(wanted):
        return [{"file": mutant["file"], "line": mutant["line"], "text": mutant["text"],
                 "operator": mutant["operator"], "change": mutant["change"], "reason": verdicts[mutant["id"]][1]}
                for mutant in mutants if verdicts[mutant["id"]][0] == wanted]
    operators = [{"operator": name, "mutants": count,
                  "killed": sum(1 for each in mutants
                                if each["operator"] == name and verdicts[each["id"]][0] == "killed")}
                 for name, count in sorted(Counter(mutant["operator"] for mutant in mutants).items())]
    killers = Counter(why for verdict, why in verdicts.values() if verdict == "killed")
    return {"operators": operators, "survivors": rows("survivor"), "equivalents": rows("equivalent"),
            "explained": rows("explained"),
            "stale_entries": [dict(zip(("file", "text", "operator", "change"), key)) for key in stale],
            "too_slow": [{"test": name} for name in slow],
            "killers": [{"test": name, "mutants": count} for name, count in killers.most_common()]}


def report(figures, tables, failing):
    for row in tables["survivors"]:
        print(f"survivor: {place_of(row)} {row['reason']}")
    for row in tables["stale_entries"]:
        print(f"equivalents: no such mutant: {row['file']}: {row['text']}: {row['change']}")
    for name in failing:
        print(f"fails without a mutant: {name}")
    for row in tables["operators"]:
        print(f"{row['operator']:14} {row['mutants']:5} mutants, {row['killed']:5} killed")
    print(", ".join(f"{name} {value:g}" for name, value in figures.items()))


def main():
    parser = argparse.ArgumentParser(prog="mutate", description=__doc__)
    parser.add_argument("--build", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--equivalents", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--json", type=Path, help="file for the figures")
    parser.add_argument("--quick", action="store_true", help=f"one mutant in {QUICK_ONE_IN}, the same ones each time")
    parser.add_argument("--only", metavar="TEXT", default="",
                        help="the mutants whose line of the report has this text, such as a file or file:line; for work on tests")
    options = parser.parse_args()
    if not (options.build / "killers").exists():
        parser.error("build the target `mutants` first")
    start = time.monotonic()
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    scratch = tempfile.TemporaryDirectory(prefix="mutation_", dir=MEMORY if os.path.isdir(MEMORY) else None)
    os.chmod(scratch.name, 0o755)
    os.environ["TMPDIR"] = tempfile.tempdir = scratch.name
    mill = Mill(options.build)
    equivalents = read_equivalents(options.equivalents)
    stale = set(equivalents) - {key_of(mutant) for mutant in mill.mutants}
    canary = [mutant for mutant in mill.mutants if mutant["operator"] == "canary"]
    mutants = [mutant for mutant in mill.mutants if mutant["operator"] != "canary"]
    if options.quick:
        mutants = random.Random(QUICK_SEED).sample(mutants, len(mutants) // QUICK_ONE_IN)
    mutants = [mutant for mutant in mutants if options.only in place_of(mutant)]
    verdicts = {}
    judge(mill, mutants, equivalents, verdicts)
    count = Counter(verdict for verdict, _ in verdicts.values())
    figures = {"mutants": len(mutants), "killed": count["killed"], "equivalent": count["equivalent"], "explained": count["explained"],
               "survivors": count["survivor"], "canary_killed": sum(mill.killer_of(each) is not None for each in canary),
               "tests": len(mill.tests), "tests_too_slow": len(mill.slow),
               "tests_failing_unmutated": len(mill.failing),
               "seconds": round(time.monotonic() - start, 1)}
    passed = not (count["survivor"] or stale or mill.failing) and figures["canary_killed"] == 1
    scratch.cleanup()
    tables = tables_of(mutants, verdicts, stale, mill.slow)
    report(figures, tables, mill.failing)
    if options.json:
        fresh = options.json.with_name(options.json.name + ".new")
        fresh.write_text(json.dumps({"tool": "mutation", "passed": passed, "figures": figures, "tables": tables}, indent=1))
        fresh.replace(options.json)
    return 0 if passed else 3


if __name__ == "__main__":
    sys.exit(main())
