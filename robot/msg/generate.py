#!/usr/bin/env python3
"""Writes everything that follows from the IDL of the messages.

usage: generate.py OUT_FOLDER FILE.idl...
OUT_FOLDER/robot/msg/fixed_messages.hpp    enums, and structs of the bus that need no heap: all that safety/ may include
OUT_FOLDER/robot/msg/messages.hpp          every struct of the bus
OUT_FOLDER/robot/msg/topics.hpp            topics: delivery, writers, protection
OUT_FOLDER/robot/msg/wire.idl              what goes over the wire, for idlc
OUT_FOLDER/robot/msg/wire_types.hpp        which field of a struct is which field on the wire
OUT_FOLDER/robot/msg/json_messages.hpp     the bus's messages as JSON, with a schema, for viewers
OUT_FOLDER/robot/msg/console_messages.hpp  the console's messages with a strict JSON codec
OUT_FOLDER/console/messages.ts             the same for the page
Structs of modules in biopsy::console are the console's, every other struct is the bus's.
"""

import json
import re
import sys
from pathlib import Path

import idl
from idl import NUMBERS, Enum, IdlError, Struct

DO_NOT_EDIT = "// Generated from the IDL in robot/msg by generate.py. Do not edit."
CONSOLE = ("biopsy", "console")
UNIONS = {"commands": "Command", "events": "Event"}  # module -> TypeScript type of any of its structs


def is_console(item):
    return item.module[:2] == CONSOLE


# The messages of the bus


class Topic:
    """What the annotations of a struct say about its topic. Raises IdlError where they leave something out."""

    def __init__(self, struct, roles):
        notes, self.struct = struct.notes, struct
        self.name = notes.get("@topic", {}).get("name", struct.name)
        delivery = self.one_of(("@best_effort", "@reliable"))
        self.reliable = delivery == "@reliable"
        self.protection = "Encrypted" if self.one_of(("@signed", "@encrypted")) == "@encrypted" else "Signed"
        if "@writers" not in notes:
            self.fail("@writers is missing: which roles may write it")
        self.writers = notes["@writers"][""].split()
        for role in self.writers:
            if role not in roles:
                self.fail(f"role {role!r} is not known; known are {', '.join(roles)}")
        if not self.writers or len(set(self.writers)) != len(self.writers):
            self.fail("@writers names no role, or one twice")
        given = notes[delivery]
        self.depth, self.lease_ms, self.deadline_ms = (
            self.whole(given, part) for part in ("depth", "lease_ms", "deadline_ms"))
        if self.depth < 1:
            self.fail(f"{delivery} needs a depth of 1 or more")
        self.transient_local = {"TRUE": True, "FALSE": False}.get(given.get("transient_local", "FALSE"))
        if self.transient_local is None:
            self.fail("transient_local is neither TRUE nor FALSE")

    def fail(self, what):
        raise IdlError(f"{self.struct.file}:{self.struct.line}: {self.struct.name}: {what}")

    def one_of(self, names):
        given = [name for name in names if name in self.struct.notes]
        if len(given) != 1:
            self.fail(f"needs one of {' and '.join(names)}")
        return given[0]

    def whole(self, given, part):
        text = given.get(part, "0")
        if not text.isdigit():
            self.fail(f"{part} is {text!r}, not a whole number")
        return int(text)


def check_bus(structs):
    for struct in structs:
        for part in struct.fields:
            where = f"{struct.file}:{part.line}: {part.name}: "
            if isinstance(part.of, Enum) and not part.of.unknown:
                raise IdlError(where + f"{part.type} needs a @default_literal, for a code that is not known")
            if isinstance(part.of, Struct) or part.type == "double":
                raise IdlError(where + f"a message of the bus cannot hold {part.type}")
            if part.type == "string" and not part.bound:
                raise IdlError(where + "a text on the bus needs a bound: string<N>")
            if part.most and part.type != "octet" or (part.most or part.count) and (part.of or part.type == "string"):
                raise IdlError(where + "on the bus there are sequences of octets and arrays of numbers only")
            if part.name == "robot":
                raise IdlError(where + "the robot's number is in every message already")


def comments(lines):
    return [f"// {line}".rstrip() for line in lines]


def with_comment(code, comment):
    return f"{code}  // {comment}" if comment else code


def cpp_enum(item):
    head = comments(item.above) + [f"enum class {item.name} : std::uint8_t {{"]
    if any(item.beside.values()):
        head += [with_comment(f"  {value},", item.beside[value]) for value in item.values] + ["};", ""]
    else:
        head[-1] += f" {', '.join(item.values)} }};"
        head.append("")
    return head


def words_of(item):
    return [" ".join(re.findall(r"[A-Z][a-z0-9]*", value)).lower() for value in item.values]


def enum_traits(item):
    """Specialised in namespace biopsy; names are the enumerators as lower-case words."""
    name = "::".join((*item.module[1:], item.name))
    words = ", ".join(f'"{word}"' for word in words_of(item))
    lines = ["template <>", f"struct EnumTraits<{name}> {{",
             f"  static constexpr std::array<std::string_view, {len(item.values)}> names{{{words}}};"]
    if item.unknown:
        lines.append(f"  static constexpr {name} unknown = {name}::{item.unknown};")
    return lines + ["};", ""]


def cpp_value(part):
    """Type and initial value of a field in C++."""
    name = "std::string" if part.type == "string" else NUMBERS.get(part.type, (part.type,))[0]
    if part.count:
        return f"std::array<{name}, {part.count}>", "{}"
    if part.most:
        return f"std::vector<{name}>", ""
    default = part.notes.get("@default", {}).get("")
    if isinstance(part.of, Enum):
        return name, f" = {name}::{default or part.of.values[0]}"
    if part.type == "string":
        return name, ""
    return name, f" = {(default or ('false' if name == 'bool' else '0')).lower()}"


def cpp_struct(item):
    lines = comments(item.above) + [f"struct {item.name} {{"]
    for part in item.fields:
        name, value = cpp_value(part)
        lines.append(with_comment(f"  {name} {part.name}{value};", part.beside))
    return lines + ["", f"  bool operator==(const {item.name}&) const = default;", "};", ""]


def cpp_header(includes, body):
    lines = [f"#include {name}" if name else "" for name in includes]
    return "\n".join([DO_NOT_EDIT, "#pragma once", "", *lines, "", *body]) + "\n"


def in_namespace(module, lines):
    name = "::".join(module)
    return [f"namespace {name} {{", "", *lines, f"}}  // namespace {name}", ""] if lines else []


def is_fixed(struct):
    return not any(part.most or part.type == "string" for part in struct.fields)


def fixed_messages(enums, structs):
    body = []
    for module in dict.fromkeys(item.module for item in enums):
        body += in_namespace(module, [line for item in enums if item.module == module for line in cpp_enum(item)])
    body += in_namespace(("biopsy",), [line for item in enums for line in enum_traits(item)] +
                         [line for item in structs if is_fixed(item) for line in cpp_struct(item)])
    return cpp_header(["<array>", "<cstdint>", "<string_view>", "", '"robot/msg/enum_traits.hpp"'], body)


def messages(structs):
    body = [line for item in structs if not is_fixed(item) for line in cpp_struct(item)]
    return cpp_header(["<string>", "<vector>", "", '"robot/msg/fixed_messages.hpp"'], in_namespace(("biopsy",), body))


def topics(given):
    lines = []
    for topic in given:
        writers = ", ".join(f"security::Role::{role}" for role in topic.writers)
        lines += ["template <>", f"inline constexpr Topic kTopic<{topic.struct.name}>{{",
                  f'    .name = "{topic.name}",',
                  f"    .reliable = {str(topic.reliable).lower()},",
                  f"    .transient_local = {str(topic.transient_local).lower()},",
                  f"    .depth = {topic.depth},",
                  f"    .lease = std::chrono::milliseconds({topic.lease_ms}),",
                  f"    .deadline = std::chrono::milliseconds({topic.deadline_ms}),",
                  f"    .writers = Writers({writers}),",
                  f"    .protection = Protection::{topic.protection}}};", ""]
    names = [topic.struct.name for topic in given]
    lines += [f"using Messages = std::tuple<{', '.join(names)}>;", "",
              f"inline constexpr std::array kTopics{{{', '.join(f'kTopic<{name}>' for name in names)}}};", "",
              "// Instantiates DO(Message) for every message.",
              f"#define BIOPSY_FOR_EACH_MESSAGE(DO) {' '.join(f'DO({name})' for name in names)}", ""]
    return cpp_header(["<tuple>", "", '"robot/msg/messages.hpp"', '"robot/msg/topic.hpp"'],
                      in_namespace(("biopsy",), lines))


def wire_field(part):
    kind = "octet" if isinstance(part.of, Enum) else part.type
    kind = f"string<{part.bound}>" if part.bound else kind
    kind = f"sequence<{kind}, {part.most}>" if part.most else kind
    count = f"[{part.count}]" if part.count else ""
    return f"      {'@key ' if '@key' in part.notes else ''}{kind} {part.name}{count};"


def wire_idl(given):
    lines = [DO_NOT_EDIT, "module biopsy {", "  module wire {"]
    for topic in given:
        lines += [f"    @final struct {topic.name} {{", "      @key unsigned long robot;",
                  *(wire_field(part) for part in topic.struct.fields), "    };", ""]
    return "\n".join(lines[:-1] + ["  };", "};"]) + "\n"


def wire_types(given):
    lines = []
    for topic in given:
        name, wire = topic.struct.name, f"biopsy_wire_{topic.name}"
        pairs = []
        for part in topic.struct.fields:
            bound = f", {part.most}" if part.most else ""
            pairs.append(f"      FieldPair{{&{name}::{part.name}, &{wire}::{part.name}{bound}}}")
        lines += ["template <>", f"struct WireType<{name}> {{", f"  using Type = {wire};",
                  f"  static const dds_topic_descriptor_t& descriptor() {{ return {wire}_desc; }}",
                  "  static constexpr std::tuple fields{", ",\n".join(pairs) + "};", "};", ""]
    return cpp_header(["<wire.h>", "", "<tuple>", "", '"robot/msg/messages.hpp"', '"robot/msg/wire_type.hpp"'],
                      in_namespace(("biopsy",), lines))


def json_schema(topic):
    """JSON Schema of a message: what its comments say, too. 64-bit numbers that JavaScript cannot hold are texts."""
    properties = {}
    for part in topic.struct.fields:
        if part.most or part.count and part.type == "octet":
            continue  # bytes
        kind = ("string" if part.of or part.type in ("string", "unsigned long long") or part.name.endswith("_ns") and part.type == "long long"
                else "boolean" if part.type == "boolean" else "integer")
        one = {"type": kind, **({"enum": words_of(part.of)} if isinstance(part.of, Enum) else {})}
        properties[part.name] = {"type": "array", "items": one} if part.count else one
        if part.beside:
            properties[part.name]["description"] = part.beside
    return {"type": "object", "title": topic.struct.name, "description": " ".join(topic.struct.above), "properties": properties}


def json_messages(given):
    lines = ["// Its JSON Schema.", "template <class Message>", 'inline constexpr const char* kJsonSchema = "";', ""]
    for topic in given:
        schema = json_schema(topic)
        long = {part.name for part in topic.struct.fields if part.type == "long long" and schema["properties"][part.name]["type"] == "string"}
        values = [f'{{"{name}", {"std::to_string" if name in long else "json_value"}(from.{name})}}' for name in schema["properties"]]
        lines += ["template <>", f"inline constexpr const char* kJsonSchema<{topic.struct.name}> =", f'    R"json({json.dumps(schema)})json";',
                  f"inline nlohmann::ordered_json json_of(const {topic.struct.name}& from) {{",
                  f"  return {{{', '.join(values)}}};", "}", ""]
    return cpp_header(["<nlohmann/json.hpp>", "<string>", "", '"robot/msg/json_value.hpp"', '"robot/msg/topics.hpp"'],
                      in_namespace(("biopsy",), lines))


# The console's messages


def console_type(part):
    name = cpp_value(part)[0] if part.type == "string" or part.of is None else part.type
    if part.of is not None and (part.count or part.most):
        return f"std::array<{name}, {part.count}>" if part.count else f"std::vector<{name}>"
    return name


def limits_of(part):
    if part.type == "string":
        return f", TextLimits{{{part.bound or 'kLongText'}}}"
    span = part.notes.get("@range")
    low, high = (span["min"], span["max"]) if span else NUMBERS.get(part.type, (None, None, None))[1:]
    exact = span or part.type in ("octet", "long", "unsigned long")  # a double cannot hold the others' limits
    return f", NumberLimits{{{float(low)!r}, {float(high)!r}}}" if low is not None and exact else ""


def console_struct(item):
    lines = [f"struct {item.name} {{", f'  static constexpr const char* kType = "{item.name}";']
    for part in item.fields:
        lines.append(with_comment(f"  {console_type(part)} {part.name}{{}};", part.notes.get("@unit", {}).get("", "")))
    lines += ["};", "", f"inline void to_json(nlohmann::json& to, const {item.name}& from) {{"]
    pairs = ", ".join(f'{{"{part.name}", from.{part.name}}}' for part in item.fields)
    lines += [f"  to = {{{pairs}}};", "}", "", f"inline void read_fields(FieldReader& fields, {item.name}& to) {{"]
    for part in item.fields:
        verb = "list" if part.most or part.count else "one"
        most = f", {part.most}" if part.most else ""
        lines.append(f'  fields.{verb}("{part.name}", to.{part.name}{most}{limits_of(part)});')
    return lines + ["}", ""]


def json_names(item):
    names = ", ".join(f'"{value}"' for value in item.values)
    return [f"constexpr std::array<const char*, {len(item.values)}> names_of({item.name}) {{",
            f"  return {{{names}}};", "}",
            f"inline void to_json(nlohmann::json& to, {item.name} from) {{",
            "  to = names_of(from)[static_cast<std::size_t>(from)];", "}", ""]


def console_messages(items, borrowed):
    body = in_namespace(("biopsy",), [line for item in borrowed for line in json_names(item)])
    for module in dict.fromkeys(item.module for item in items):
        lines = []
        for item in items:
            if item.module == module:
                lines += cpp_enum(item) + json_names(item) if isinstance(item, Enum) else console_struct(item)
        if module[-1] == "commands":
            names = [item.name for item in items if item.module == module and isinstance(item, Struct)]
            lines += [f"using Any = std::variant<{', '.join(names)}>;", ""]
        body += in_namespace(module, lines)
    return cpp_header(["<variant>", "", '"robot/msg/fixed_messages.hpp"', '"robot/msg/json_fields.hpp"'], body)


def ts_type(part):
    name = {"string": "string", "boolean": "boolean"}.get(part.type)
    name = name or ("number" if part.type in NUMBERS else part.type)
    if part.count:
        return f"[{', '.join([name] * part.count)}]"
    return f"{name}[]" if part.most else name


def typescript(items, borrowed):
    lines = [DO_NOT_EDIT, ""]
    for item in [*borrowed, *items]:
        if isinstance(item, Enum):
            values = " | ".join(f"'{value}'" for value in item.values)
            lines += [f"export type {item.name} = {values}", ""]
            continue
        lines.append(f"export interface {item.name} {{")
        lines += [with_comment(f"  {part.name}: {ts_type(part)}", part.notes.get("@unit", {}).get("", ""))
                  for part in item.fields]
        lines += ["}", ""]
    for module, union in UNIONS.items():
        names = [item.name for item in items if isinstance(item, Struct) and item.module[-1] == module]
        lines += [f"export type {union} =", *(f"  | ({{ type: '{name}' }} & {name})" for name in names), ""]
    return "\n".join(lines)


def check_console(structs):
    for struct in structs:
        if struct.notes:
            note = next(iter(struct.notes))
            raise IdlError(f"{struct.file}:{struct.line}: {struct.name}: {note} is for the bus only")


def outputs(found):
    """File name -> text of everything that follows from these enums and structs."""
    enums = [item for item in found if isinstance(item, Enum) and not is_console(item)]
    structs = [item for item in found if isinstance(item, Struct) and not is_console(item)]
    console = [item for item in found if is_console(item)]
    roles = next((item.values for item in enums if item.name == "Role"), [])
    given = [Topic(struct, roles) for struct in structs]
    check_bus(structs)
    check_console([item for item in console if isinstance(item, Struct)])
    used = [part.of for item in console if isinstance(item, Struct) for part in item.fields]
    borrowed = [item for item in enums if any(item is each for each in used)]
    return {
        "robot/msg/fixed_messages.hpp": fixed_messages(enums, structs),
        "robot/msg/messages.hpp": messages(structs),
        "robot/msg/topics.hpp": topics(given),
        "robot/msg/wire.idl": wire_idl(given),
        "robot/msg/wire_types.hpp": wire_types(given),
        "robot/msg/json_messages.hpp": json_messages(given),
        "robot/msg/console_messages.hpp": console_messages(console, borrowed),
        "console/messages.ts": typescript(console, borrowed),
    }


def main(folder, paths):
    try:
        written = outputs(idl.read(paths))
    except IdlError as error:
        sys.exit(f"{error}")
    for name, text in written.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text() != text:  # what did not change need not be compiled again
            path.write_text(text)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), sys.argv[2:])
