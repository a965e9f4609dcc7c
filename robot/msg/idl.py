"""Reads the part of OMG IDL 4.2 that this project's messages use, and refuses everything else with file and line.

Modules, enums, structs of numbers, texts, sequences and arrays, and annotations; a comment beside a field or above a
declaration belongs to it.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

NUMBERS = {  # IDL: (C++, lowest, highest)
    "boolean": ("bool", None, None),
    "octet": ("std::uint8_t", 0, 2**8 - 1),
    "long": ("std::int32_t", -(2**31), 2**31 - 1),
    "unsigned long": ("std::uint32_t", 0, 2**32 - 1),
    "long long": ("std::int64_t", -(2**63), 2**63 - 1),
    "unsigned long long": ("std::uint64_t", 0, 2**64 - 1),
    "double": ("double", None, None),
}
ANNOTATIONS = {  # where: {name: its parameters; "": one value without a name}
    "struct": {"@topic": {"name"}, "@writers": {""}, "@signed": set(), "@encrypted": set(),
               "@best_effort": {"depth", "lease_ms", "deadline_ms", "transient_local"},
               "@reliable": {"depth", "lease_ms", "deadline_ms", "transient_local"}},
    "enumerator": {"@default_literal": set()},
    "field": {"@key": set(), "@default": {""}, "@unit": {""}, "@range": {"min", "max"}},
}
TOKEN = re.compile(r'(?P<space>[ \t\r\n]+)|//(?P<comment>[^\n]*)|(?P<text>"[^"\n]*")|(?P<number>-?\d[\w.+]*)'
                   r"|(?P<word>@?[A-Za-z_]\w*)|(?P<sign>[{}()<>\[\],;=])")


class IdlError(Exception):
    """Its text begins with file and line."""


@dataclass
class Token:
    kind: str
    text: str
    line: int
    above: list = field(default_factory=list)  # comments on the lines before it
    beside: str = ""  # comment behind it on its line


@dataclass
class Field:
    name: str
    type: str  # of IDL, or the name of an enum or struct; of an element, where it is a list
    line: int
    notes: dict  # annotations: name -> {parameter: text}
    bound: int = 0  # of a text, 0: none
    most: int = 0  # of a sequence, 0: not one
    count: int = 0  # of an array, 0: not one
    beside: str = ""
    of: object = None  # the Enum or Struct that `type` names


@dataclass
class Struct:
    file: str
    line: int
    module: tuple
    name: str
    notes: dict
    above: list
    fields: list = field(default_factory=list)


@dataclass
class Enum:
    file: str
    line: int
    module: tuple
    name: str
    above: list
    values: list = field(default_factory=list)
    beside: dict = field(default_factory=dict)  # enumerator -> comment
    unknown: str = ""  # @default_literal: stands for a code that is not known


def tokens_of(text, file):
    found, above, line, at = [], [], 1, 0
    while at < len(text):
        match = TOKEN.match(text, at)
        if not match:
            raise IdlError(f"{file}:{line}: cannot read {text[at:].splitlines()[0][:30]!r}")
        kind, part = match.lastgroup, match.group(match.lastgroup)
        if kind == "comment":
            if found and found[-1].line == line:
                found[-1].beside = part.strip()
            else:
                above.append(part.strip())
        elif kind != "space":
            found.append(Token(kind, part, line, above))
            above = []
        elif "\n\n" in part:
            above = []  # a blank line ends what belongs to the next declaration
        line += part.count("\n")
        at = match.end()
    return found


class Reader:
    """One file. `known` holds what was declared in the files before it and takes what this one declares."""

    def __init__(self, path, known):
        self.file, self.known, self.found = path.name, known, []
        self.tokens, self.at = tokens_of(path.read_text(), self.file), 0

    def fail(self, what, line=None):
        raise IdlError(f"{self.file}:{line or self.peek().line}: {what}")

    def peek(self):
        last = self.tokens[-1].line if self.tokens else 1
        return self.tokens[self.at] if self.at < len(self.tokens) else Token("end", "the end of the file", last)

    def next(self, wanted=None, kind=None):
        token = self.peek()
        if (wanted is not None and token.text != wanted) or (kind is not None and token.kind != kind):
            self.fail(f"{wanted or kind} expected, {token.text!r} found")
        self.at += 1
        return token

    def accept(self, text):
        if self.peek().text != text:
            return False
        self.at += 1
        return True

    def number(self):
        token = self.next(kind="number")
        if not token.text.isdigit() or int(token.text) < 1:
            self.fail(f"{token.text!r} is no size", token.line)
        return int(token.text)

    def read(self, module=()):
        while self.peek().text not in ("}", "the end of the file"):
            above = self.peek().above
            notes = self.annotations("struct")
            keyword = self.next(kind="word")
            name = self.next(kind="word").text
            if notes and keyword.text != "struct":
                self.fail(f"{next(iter(notes))} belongs to a struct", keyword.line)
            if keyword.text == "module":
                self.next("{")
                self.read((*module, name))
                self.next("}")
            elif keyword.text == "enum":
                self.enum(Enum(self.file, keyword.line, module, name, above))
            elif keyword.text == "struct":
                self.struct(Struct(self.file, keyword.line, module, name, notes, above))
            else:
                self.fail(f"{keyword.text!r} is not known here; known are module, enum and struct", keyword.line)
            self.next(";")
        return self.found

    def annotations(self, where):
        notes = {}
        while self.peek().text.startswith("@"):
            name, parameters = self.next(), {}
            allowed = ANNOTATIONS[where].get(name.text)
            if allowed is None:
                self.fail(f"{where} annotation {name.text} is not known", name.line)
            if name.text in notes:
                self.fail(f"{name.text} is there twice", name.line)
            if self.accept("("):
                while not self.accept(")"):
                    value, key = self.next(), ""
                    if self.accept("="):
                        key, value = value.text, self.next()
                    if key not in allowed or key in parameters:
                        self.fail(f"{name.text} takes no {key or value.text!r} here", name.line)
                    parameters[key] = value.text.strip('"')
                    if self.peek().text != ")":
                        self.next(",")
            if allowed == {""} and not parameters:
                self.fail(f"{name.text} needs a value", name.line)
            notes[name.text] = parameters
        return notes

    def declare(self, made):
        if any(name.lower() == made.name.lower() for name in self.known):
            self.fail(f"{made.name!r} is declared twice", made.line)
        self.known[made.name] = made
        self.found.append(made)

    def enum(self, made):
        self.next("{")
        while not self.accept("}"):
            notes = self.annotations("enumerator")
            value = self.next(kind="word")
            if value.text in made.values:
                self.fail(f"enumerator {value.text!r} is there twice", value.line)
            made.values.append(value.text)
            if notes:
                made.unknown = value.text
            last = value
            if self.peek().text != "}":
                last = self.next(",")
            made.beside[value.text] = value.beside or last.beside
        if not 1 <= len(made.values) <= 256:
            self.fail(f"{made.name!r} needs 1 to 256 values: one octet on the wire", made.line)
        self.declare(made)

    def struct(self, made):
        self.next("{")
        while not self.accept("}"):
            part = self.field()
            if any(other.name.lower() == part.name.lower() for other in made.fields):
                self.fail(f"field {part.name!r} is there twice", part.line)
            made.fields.append(part)
        if not made.fields:
            self.fail(f"{made.name!r} has no field", made.line)
        self.declare(made)

    def field(self):
        made = Field("", "", self.peek().line, self.annotations("field"))
        if self.accept("sequence"):
            self.next("<")
            self.type(made)
            self.next(",")
            made.most = self.number()
            self.next(">")
        else:
            self.type(made)
        made.name = self.next(kind="word").text
        if self.accept("["):
            made.count = self.number()
            self.next("]")
        end = self.next(";")
        made.beside = end.beside
        self.check_default(made)
        return made

    def type(self, made):
        words = [self.next(kind="word").text]
        while words[0] in ("unsigned", "long") and self.peek().text == "long":
            words.append(self.next().text)
        made.type = " ".join(words)
        if made.type == "string":
            if self.accept("<"):
                made.bound = self.number()
                self.next(">")
        elif made.type not in NUMBERS:
            made.of = self.known.get(made.type)
            if made.of is None:
                self.fail(f"type {made.type!r} is not known", made.line)

    def check_default(self, made):
        value = made.notes.get("@default", {}).get("")
        if value is None:
            return
        single = not (made.most or made.count)
        if isinstance(made.of, Enum):
            fits = single and value in made.of.values
        elif made.type == "boolean":
            fits = single and value in ("TRUE", "FALSE")
        else:
            _, low, high = NUMBERS.get(made.type, (None, None, None))
            fits = single and low is not None and re.fullmatch(r"-?\d+", value) and low <= int(value) <= high
        if not fits:
            self.fail(f"{value!r} is no value of {made.name!r}", made.line)


def read(paths):
    """Every enum and struct of the files, in order; a file may use what the files before it declare."""
    known = {}
    return [item for path in paths for item in Reader(Path(path), known).read()]
