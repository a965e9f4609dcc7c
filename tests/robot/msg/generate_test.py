#!/usr/bin/env python3
"""What the generator of the messages refuses, with file and line, and what it makes of an IDL it accepts."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

ROOM = Path(__file__).resolve().parents[3] / "robot" / "msg"
sys.path.insert(0, str(ROOM))
import generate  # noqa: E402  (found by the line above)
import idl  # noqa: E402

GOOD = """module biopsy {
  module security { enum Role { Stage, Console }; };
  enum Mode { Off, @default_literal Locked, On };
  @writers("Stage") @signed @best_effort(depth=2, lease_ms=20)
  struct Sample {
    unsigned long seq;
    Mode mode;  // what it does
    @default(TRUE) boolean busy;
    string<8> note;
    sequence<octet, 9> bytes;
    long long at[2];
  };
};
"""
# line of GOOD -> what replaces it, and what the refusal says
BAD = [
    (6, "    @colour(1) unsigned long seq;", "field annotation @colour is not known"),
    (6, "    unsigned short seq;", "type 'unsigned' is not known"),
    (6, "    Colour seq;", "type 'Colour' is not known"),
    (7, "    Mode seq;", "field 'seq' is there twice"),
    (7, "    Mode SEQ;", "field 'SEQ' is there twice"),  # names that differ in case alone are one in IDL
    (7, "    @default(Open) Mode mode;", "'Open' is no value of 'mode'"),
    (8, "    @default(2) boolean busy;", "'2' is no value of 'busy'"),
    (6, "    @default(-1) unsigned long seq;", "'-1' is no value of 'seq'"),
    (6, "    @default(1) @default(2) unsigned long seq;", "@default is there twice"),
    (9, "    string note;", "a text on the bus needs a bound"),
    (10, "    sequence<long, 9> bytes;", "sequences of octets"),
    (10, "    sequence<octet> bytes;", ", expected, '>' found"),
    (11, "    double at[2];", "cannot hold double"),
    (11, "    long long at[0];", "'0' is no size"),
    (11, "    unsigned long robot;", "the robot's number is in every message already"),
    (3, "  enum Mode { Off, Locked, On };", "needs a @default_literal"),
    (3, "  enum Mode { Off, Off, @default_literal On };", "enumerator 'Off' is there twice"),
    (3, "  enum Mode { Off, @key On };", "enumerator annotation @key is not known"),
    (3, "  union Mode { Off };", "'union' is not known here"),
    (4, '  @writers("Nurse") @signed @reliable(depth=1)', "role 'Nurse' is not known; known are Stage, Console"),
    (4, "  @signed @reliable(depth=1)", "@writers is missing"),
    (4, '  @writers("") @signed @reliable(depth=1)', "@writers names no role"),
    (4, '  @writers("Stage") @reliable(depth=1)', "needs one of @signed and @encrypted"),
    (4, '  @writers("Stage") @signed', "needs one of @best_effort and @reliable"),
    (4, '  @writers("Stage") @signed @reliable(lease_ms=5)', "needs a depth of 1 or more"),
    (4, '  @writers("Stage") @signed @reliable(depth=1, delay_ms=5)', "@reliable takes no 'delay_ms' here"),
    (4, '  @writers("Stage") @signed @reliable(depth=1, transient_local=YES)', "neither TRUE nor FALSE"),
    (1, "module biopsy ( ", "{ expected, '(' found"),
    (13, "", "} expected"),
    (6, "    unsigned long seq; $", "cannot read '$'"),
]


def outputs_of(text):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "given.idl"
        path.write_text(text)
        return generate.outputs(idl.read([path]))


class Refusals(unittest.TestCase):
    def test_each_names_file_and_line(self):
        for number, line, refusal in BAD:
            lines = GOOD.splitlines()
            lines[number - 1] = line
            with self.subTest(line=line):
                with self.assertRaises(idl.IdlError) as raised:
                    outputs_of("\n".join(lines))
                text = str(raised.exception)
                self.assertRegex(text, r"^given\.idl:\d+: ")
                self.assertIn(refusal, text)
                lines_named = {3: (3, 7), 4: (4, 5), 13: (12, 13)}.get(number, (number,))
                self.assertIn(int(text.split(":")[1]), lines_named, text)

    def test_the_console_has_no_topics(self):
        text = 'module biopsy { module console { module events {\n@signed struct State { long seq; }; }; }; };'
        with self.assertRaisesRegex(idl.IdlError, r"^given\.idl:2: State: @signed is for the bus only"):
            outputs_of(text)


class Outputs(unittest.TestCase):
    def test_a_field_is_one_line_of_idl(self):
        before = outputs_of(GOOD)
        after = outputs_of(GOOD.replace("    Mode mode;", "    long depth_um;\n    Mode mode;"))
        for name, expected in {"messages.hpp": "  std::int32_t depth_um = 0;", "wire.idl": "      long depth_um;",
                               "wire_types.hpp": "FieldPair{&Sample::depth_um, &biopsy_wire_Sample::depth_um}"}.items():
            added = set(after["robot/msg/" + name].splitlines()) - set(before["robot/msg/" + name].splitlines())
            self.assertEqual(len(added), 1, name)
            self.assertIn(expected, added.pop())

    def test_defaults_comments_and_bounds_are_kept(self):
        text = outputs_of(GOOD)["robot/msg/messages.hpp"]
        for line in ("Mode mode = Mode::Off;  // what it does", "bool busy = true;", "std::string note;",
                     "std::vector<std::uint8_t> bytes;", "std::array<std::int64_t, 2> at{};"):
            self.assertIn("\n  " + line + "\n", text)

    def test_messages_as_json_have_a_schema_with_their_comments(self):
        text = outputs_of(GOOD.replace("    long long at[2];", "    long long at_ns;\n    unsigned long long tag[2];"))["robot/msg/json_messages.hpp"]
        schema = json.loads(text[text.index('R"json(') + 7:text.index(')json"')])
        self.assertEqual(schema["properties"], {
            "seq": {"type": "integer"}, "mode": {"type": "string", "enum": ["off", "locked", "on"], "description": "what it does"},
            "busy": {"type": "boolean"}, "note": {"type": "string"}, "at_ns": {"type": "string"},
            "tag": {"type": "array", "items": {"type": "string"}}})  # bytes are left out; JavaScript holds no 64 bits
        self.assertIn('{"at_ns", std::to_string(from.at_ns)}, {"tag", json_value(from.tag)}', text)

    def test_the_real_files_give_a_header_without_a_heap_for_safety(self):
        made = generate.outputs(idl.read([ROOM / "bus.idl", ROOM / "console.idl", ROOM / "review.idl"]))
        text = made["robot/msg/fixed_messages.hpp"]
        for name in ("Measurement", "DriveRequest", "Permit"):
            self.assertIn(f"struct {name} {{", text)
        self.assertNotIn("std::string ", text)
        self.assertNotIn("std::vector", text)


if __name__ == "__main__":
    unittest.main()
