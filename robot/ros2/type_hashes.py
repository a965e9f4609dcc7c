#!/usr/bin/env python3
"""type_hashes.py MESSAGES.idl HEADER: the RIHS01 hash of each type, as REP-2016 computes it from a type description."""

import hashlib
import json
import re
import sys
from pathlib import Path

# type_description_interfaces/msg/FieldType
NESTED, ARRAY, UNBOUNDED_SEQUENCE = 1, 48, 144
PRIMITIVES = {"uint8": 3, "long": 6, "unsigned long": 7, "double": 11, "octet": 16, "string": 17}
BOUNDED_STRING = 21
FIELD = re.compile(r"^(?P<sequence>sequence<)?(?P<type>[\w: ]+?)(?:<(?P<bound>\d+)>)?(?(sequence)>) (?P<name>\w+)(?:\[(?P<length>\d+)\])?$")


def ros_name(dds_name: str) -> str:
    """sensor_msgs/msg/JointState of sensor_msgs::msg::dds_::JointState_."""
    package, kind, _, name = dds_name.split("::")
    return f"{package}/{kind}/{name[:-1]}"


def field_of(text: str) -> dict:
    found = FIELD.match(text)
    if not found:
        sys.exit(f"error: a field that is not understood: {text}")
    kind = {"type_id": NESTED, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}
    if "::" in found["type"]:
        kind["nested_type_name"] = ros_name(found["type"])
    elif found["bound"]:
        kind |= {"type_id": BOUNDED_STRING, "string_capacity": int(found["bound"])}
    else:
        kind["type_id"] = PRIMITIVES[found["type"]]
    if found["sequence"]:
        kind["type_id"] += UNBOUNDED_SEQUENCE
    if found["length"]:
        kind |= {"type_id": kind["type_id"] + ARRAY, "capacity": int(found["length"])}
    return {"name": found["name"], "type": kind}


def structs_of(idl: str) -> dict[str, dict]:
    text = re.sub(r"//.*", "", idl)
    structs, package = {}, ""
    for found in re.finditer(r"module (\w+) \{ module msg|struct (\w+)_ \{([^}]*)\}", text):
        if found[1]:
            package = found[1]
            continue
        fields = [" ".join(field.split()) for field in found[3].split(";") if field.strip()]
        name = f"{package}/msg/{found[2]}"
        structs[name] = {"type_name": name, "fields": [field_of(field) for field in fields]}
    return structs


def referenced(structs: dict[str, dict], name: str) -> set[str]:
    direct = {field["type"]["nested_type_name"] for field in structs[name]["fields"]} - {""}
    return direct.union(*(referenced(structs, inner) for inner in direct))


def hash_of(structs: dict[str, dict], name: str) -> str:
    description = {"type_description": structs[name],
                   "referenced_type_descriptions": [structs[inner] for inner in sorted(referenced(structs, name))]}
    return "RIHS01_" + hashlib.sha256(json.dumps(description).encode()).hexdigest()


def main(idl: Path, header: Path) -> int:
    structs = structs_of(idl.read_text())
    lines = [f'  if (type == "{name}") return "{hash_of(structs, name)}";' for name in structs]
    header.parent.mkdir(parents=True, exist_ok=True)
    header.write_text("// Made of ros2_messages.idl by type_hashes.py.\n#pragma once\n\n#include <string_view>\n\n"
                      "namespace biopsy::ros2 {\n\n// Of a type such as std_msgs/msg/Header; empty: not one of ros2_messages.idl.\n"
                      "constexpr std::string_view type_hash(std::string_view type) {\n" + "\n".join(lines) +
                      "\n  return {};\n}\n\n}  // namespace biopsy::ros2\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
