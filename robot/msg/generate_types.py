#!/usr/bin/env python3
"""Types of the console's page and server from one source, the IDL.

generate_types.py --ts OUT.ts FILE.idl...   TypeScript interfaces of every struct
generate_types.py --cpp OUT.hpp FILE.idl    C++ structs with a strict JSON codec

Knows the part of IDL that these files use: modules, enums, structs of numbers, text, sequences and arrays, and the
annotations @unit and @range. Anything else is an error, not a guess.
"""

import argparse
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

NUMBERS = {  # IDL: (C++, lowest, highest)
    "boolean": ("bool", None, None),
    "octet": ("std::uint8_t", 0, 255),
    "long": ("std::int32_t", -(2**31), 2**31 - 1),
    "unsigned long": ("std::uint32_t", 0, 2**32 - 1),
    "long long": ("std::int64_t", None, None),
    "unsigned long long": ("std::uint64_t", None, None),
    "double": ("double", None, None),
}
TOKEN = re.compile(r'\s+|//[^\n]*|(@\w+(?:\([^)]*\))?|"[^"]*"|\w+|[{};<>\[\],])')


@dataclass
class Field:
    name: str
    type: str  # of IDL; of an element, where it is a list
    bound: int = 0  # of a text, 0: none
    most: int = 0  # of a sequence, 0: not one
    count: int = 0  # of an array, 0: not one
    unit: str = ""
    lowest: float = None
    highest: float = None


@dataclass
class Struct:
    module: tuple
    name: str
    fields: list = field(default_factory=list)


@dataclass
class Enum:
    module: tuple
    name: str
    values: list = field(default_factory=list)


class Reader:
    def __init__(self, text, name):
        self.name, self.tokens, place = name, [], 0
        while place < len(text):
            match = TOKEN.match(text, place)
            if not match:
                sys.exit(f"{name}: cannot read {text[place:place + 30]!r}")
            if match.group(1):
                self.tokens.append(match.group(1))
            place = match.end()
        self.at, self.found = 0, []

    def next(self, wanted=None):
        token = self.tokens[self.at] if self.at < len(self.tokens) else "the end"
        if wanted is not None and token != wanted:
            sys.exit(f"{self.name}: {wanted!r} expected, {token!r} found")
        self.at += 1
        return token

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def read(self, module=()):
        while self.peek() not in ("", "}"):
            word = self.next()
            if word.startswith("@"):
                continue
            name = self.next()
            if word == "module":
                self.next("{")
                self.read((*module, name))
                self.next("}")
            elif word == "enum":
                self.enum(Enum(module, name))
            elif word == "struct":
                self.struct(Struct(module, name))
            else:
                sys.exit(f"{self.name}: {word!r} is not known here")
            self.next(";")
        return self.found

    def enum(self, made):
        self.next("{")
        while self.peek() != "}":
            made.values.append(self.next())
            if self.peek() == ",":
                self.next()
        self.next("}")
        self.found.append(made)

    def struct(self, made):
        self.next("{")
        while self.peek() != "}":
            made.fields.append(self.field())
        self.next("}")
        self.found.append(made)

    def field(self):
        made = Field("", "")
        while self.peek().startswith("@"):
            note = self.next()
            if unit := re.match(r'@unit\("(.*)"\)', note):
                made.unit = unit.group(1)
            if span := re.match(r"@range\(min=([^,]*), *max=(.*)\)", note):
                made.lowest, made.highest = float(span.group(1)), float(span.group(2))
        if self.peek() == "sequence":
            self.next()
            self.next("<")
            self.type(made)
            self.next(",")
            made.most = int(self.next())
            self.next(">")
        else:
            self.type(made)
        made.name = self.next()
        if self.peek() == "[":
            self.next()
            made.count = int(self.next())
            self.next("]")
        self.next(";")
        return made

    def type(self, made):
        words = [self.next()]
        while words[0] in ("unsigned", "long") and self.peek() == "long":
            words.append(self.next())
        made.type = " ".join(words)
        if made.type == "string" and self.peek() == "<":
            self.next()
            made.bound = int(self.next())
            self.next(">")


def typescript(found):
    lines = ["// Generated from the IDL by generate_types.py. Do not edit.", ""]
    for item in found:
        if isinstance(item, Enum):
            values = " | ".join(f"'{value}'" for value in item.values)
            lines += [f"export type {item.name} = {values}", ""]
            continue
        lines.append(f"export interface {item.name} {{")
        for part in item.fields:
            lines.append(f"  {part.name}: {ts_type(part)}" + (f" // {part.unit}" if part.unit else ""))
        lines += ["}", ""]
    for module, union in (("commands", "Command"), ("events", "Event")):
        names = [i.name for i in found if isinstance(i, Struct) and i.module[-1] == module]
        if names:
            members = "\n".join(f"  | ({{ type: '{name}' }} & {name})" for name in names)
            lines += [f"export type {union} =", members, ""]
    return "\n".join(lines)


def ts_type(part):
    name = {"string": "string", "boolean": "boolean"}.get(part.type)
    name = name or ("number" if part.type in NUMBERS else part.type)
    if part.count:
        return f"[{', '.join([name] * part.count)}]"
    return f"{name}[]" if part.most else name


def cpp_type(part):
    name = "std::string" if part.type == "string" else NUMBERS.get(part.type, (part.type,))[0]
    if part.count:
        return f"std::array<{name}, {part.count}>"
    return f"std::vector<{name}>" if part.most else name


def limits_of(part):
    if part.type == "string":
        return f", TextLimits{{{part.bound or 'kLongText'}}}"
    low, high = part.lowest, part.highest
    if low is None:
        _, low, high = NUMBERS.get(part.type, (None, None, None))
    return "" if low is None else f", NumberLimits{{{float(low)!r}, {float(high)!r}}}"


def cpp_struct(item):
    lines = [f"struct {item.name} {{", f'  static constexpr const char* kType = "{item.name}";']
    for part in item.fields:
        unit = f"  // {part.unit}" if part.unit else ""
        lines.append(f"  {cpp_type(part)} {part.name}{{}};{unit}")
    lines += ["};", ""]
    lines.append(f"inline void to_json(nlohmann::json& to, const {item.name}& from) {{")
    parts = "".join(f'{{"{part.name}", from.{part.name}}}, ' for part in item.fields).rstrip(", ")
    lines += [f"  to = {{{parts}}};", "}", ""]
    lines.append(f"inline void read_fields(FieldReader& fields, {item.name}& to) {{")
    for part in item.fields:
        most = f", {part.most}" if part.most else ""
        verb = "list" if part.most or part.count else "one"
        lines.append(f'  fields.{verb}("{part.name}", to.{part.name}{most}{limits_of(part)});')
    lines += ["}", ""]
    return lines


def cpp(found):
    lines = [
        "// Generated from the IDL by generate_types.py. Do not edit.",
        "#pragma once",
        "",
        '#include "robot/console/server/json_fields.hpp"',
        "",
        "#include <variant>",
        "",
    ]
    module = None
    for item in found:
        if item.module != module:
            if module:
                lines += [f"}}  // namespace {'::'.join(module)}", ""]
            module = item.module
            lines += [f"namespace {'::'.join(module)} {{", ""]
        if isinstance(item, Enum):
            lines.append(f"enum class {item.name} : std::uint8_t {{ {', '.join(item.values)} }};")
            names = ", ".join(f'"{value}"' for value in item.values)
            lines.append(f"constexpr std::array<const char*, {len(item.values)}> names_of({item.name}) {{")
            lines += [f"  return {{{names}}};", "}"]
            lines.append(f"inline void to_json(nlohmann::json& to, {item.name} from) {{")
            lines += ["  to = names_of(from)[static_cast<std::size_t>(from)];", "}", ""]
        else:
            lines += cpp_struct(item)
    commands = ", ".join(i.name for i in found if isinstance(i, Struct) and i.module[-1] == "commands")
    lines += [f"}}  // namespace {'::'.join(module)}", "", "namespace biopsy::console::commands {", ""]
    lines += [f"using Any = std::variant<{commands}>;", "", "}  // namespace biopsy::console::commands"]
    return "\n".join(lines) + "\n"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--ts", type=Path)
    options.add_argument("--cpp", type=Path)
    options.add_argument("files", type=Path, nargs="+")
    given = options.parse_args()
    found = [item for file in given.files for item in Reader(file.read_text(), file.name).read()]
    if given.ts:
        given.ts.write_text(typescript(found))
    if given.cpp:
        given.cpp.write_text(cpp(found))


if __name__ == "__main__":
    main()
