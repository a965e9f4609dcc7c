#!/usr/bin/python3
"""Writes a copy of the safety core that holds every mutant at once, and the list of them.

usage: schemata.py SOURCE_FOLDER OUT_FOLDER GENERATED_FOLDER [CANARY FILE ...]
Without files: all of safety/. With them: these alone, members of a record are also taken for their neighbours of the same
type, and the canary is the mutant that leaves out the statement CANARY.
OUT_FOLDER/mutated/... has the sources, OUT_FOLDER/mutants.json the list. In the copy an expression that has
mutants reads (mutation::on(17) ? (changed) : (original)); what was constexpr is filled in before main(), so
that constants and tables have mutants too.
"""

import json
import os
import sys
from pathlib import Path

from clang.cindex import CursorKind as K, Index

import operators

FUNCTIONS = (K.FUNCTION_DECL, K.CXX_METHOD, K.CONSTRUCTOR, K.DESTRUCTOR, K.CONVERSION_FUNCTION, K.LAMBDA_EXPR)
VARIABLES = (K.VAR_DECL, K.FIELD_DECL)
CANARY = ("event_of", "return Event::None;")  # a supervisor that never leaves its mode: if this lives, nothing counts
CONSTANT_WORDS, WORD_LENGTH = ("constexpr", "consteval"), 9
DELETED = ""  # an operand of a comma or a statement that is left out


class Source:
    """One file: its text, and what may stand in place of which part of it."""

    def __init__(self, root, name):
        self.name, self.text = name, (root / name).read_text()
        self.changes = {}  # (begin, end, is a statement) -> [(operator, changed text)]
        self.keywords = {}  # offset of `constexpr` or `consteval` -> what stands there instead
        self.asserts = {}  # (begin, end) of a static_assert -> its condition
        assert self.text.isascii(), name  # offsets count bytes

    def of(self, node):
        return self.text[node.extent.start.offset:node.extent.end.offset]

    def change(self, node, found, statement=False):
        begin, end = node.extent.start.offset, node.extent.end.offset
        if statement:
            end += len(self.text[end:]) - len(self.text[end:].lstrip())
            end += self.text[end:end + 1] == ";"
        have = self.changes.setdefault((begin, end, statement), [])
        have += [each for each in dict.fromkeys(found) if each not in have]
        if not have:
            del self.changes[begin, end, statement]


class Finder:
    """Walks one syntax tree and notes the changes in its sources."""

    def __init__(self, sources, sizes, neighbours):
        self.neighbours = neighbours  # whether a member is also taken for its neighbour
        self.sources, self.sizes = sources, sizes  # sizes: names, and where the declarations start that make them

    def walk(self, node, function=None, in_table=False):
        for child in node.get_children():
            source = self.source_of(child)
            if source is None:
                continue
            if self.neighbours and (child.kind == K.PARM_DECL or source.of(child).startswith("assert(")):
                continue  # types, and what a release leaves out
            if child.kind == K.CASE_STMT:  # a label must be constant
                self.walk_case(child, source, function)
                continue
            if child.kind == K.STATIC_ASSERT:
                condition = next(child.get_children())
                source.asserts[child.extent.start.offset, child.extent.end.offset] = source.of(condition)
                continue
            inner, table = (child if child.kind in FUNCTIONS else function), in_table
            if child.kind in VARIABLES or child.kind in FUNCTIONS:
                if self.note_keyword(child, source) == "consteval":
                    continue  # runs in the compiler only: no part of what ships
            if child.kind == K.VAR_DECL and function is None:
                table = True
            if child.kind in VARIABLES:
                self.walk_variable(child, source, inner, table)
                continue
            self.note(child, source, inner, table)
            self.walk(child, inner, table)

    def source_of(self, node):
        file = node.location.file
        return self.sources.get(os.path.normpath(file.name)) if file else None

    def walk_case(self, node, source, function):
        body = list(node.get_children())[-1]
        if body.kind == K.CASE_STMT:
            return self.walk_case(body, source, function)
        self.note_statement(body, source)
        self.note(body, source, function, False)
        self.walk(body, function)

    def walk_variable(self, node, source, function, table):
        """Only the initialiser: what stands before the name is a size or a type."""
        if (source.name, node.extent.start.offset) in self.sizes:
            return
        for child in node.get_children():
            begins_behind = child.extent.start.offset > node.location.offset
            if begins_behind:
                self.note(child, source, function, table)
            # What calls a constructor, as `milliseconds kEvery{500}`, begins at the name.
            if begins_behind or child.kind == K.CALL_EXPR and child.extent.end.offset > node.location.offset:
                self.walk(child, function, table)

    def note_keyword(self, node, source):
        """Which of constexpr and consteval it has, if it has to be filled in or run before main()."""
        head = source.text[node.extent.start.offset:node.location.offset]
        word = next((word for word in CONSTANT_WORDS if word in head), None)
        if word is None or node.kind == K.LAMBDA_EXPR or (source.name, node.extent.start.offset) in self.sizes:
            return None
        in_class = node.semantic_parent.kind in (K.STRUCT_DECL, K.CLASS_DECL)
        # Not const either: a compiler may put what is const into memory that it cannot fill in before main().
        words = {K.VAR_DECL: "inline" if in_class else "", K.FUNCTION_DECL: "inline"}
        source.keywords[node.extent.start.offset + head.index(word)] = words.get(node.kind, "")
        return word

    def note(self, node, source, function, in_table):
        kind, text = node.kind, source.of(node)
        children = list(node.get_children())
        if kind in (K.BINARY_OPERATOR, K.COMPOUND_ASSIGNMENT_OPERATOR) and len(children) == 2:
            self.note_binary(node, source, *children)
        elif kind == K.UNARY_OPERATOR:
            source.change(node, operators.of_unary(node, text))
        elif kind == K.CONDITIONAL_OPERATOR:
            source.change(children[0], operators.of_condition(children[0], source.of(children[0])))
        elif kind == K.INTEGER_LITERAL and text[:1].isdigit():
            source.change(node, operators.of_integer(text))
            if self.neighbours and in_table and int(text.replace("'", "").rstrip("uUlL"), 0) > 1:
                source.change(node, operators.of_unit(text))
        elif kind == K.FLOATING_LITERAL and self.neighbours and text[:1].isdigit():
            source.change(node, operators.of_floating(text))
        elif kind == K.CXX_BOOL_LITERAL_EXPR:
            source.change(node, operators.of_boolean(text))
        elif kind == K.DECL_REF_EXPR and node.referenced is not None:
            self.note_name(node, source, text, in_table)
        elif kind == K.MEMBER_REF_EXPR and self.neighbours and node.referenced is not None:
            source.change(node, operators.of_member(node, text))
        elif kind == K.RETURN_STMT and children:
            self.note_return(node, source, children[0], function)
        elif kind.is_statement():
            self.note_parts(node, source, children)
            if kind == K.SWITCH_STMT and function.spelling == CANARY[0]:
                source.change(node, [("canary", CANARY[1])], statement=True)

    def note_binary(self, node, source, left, right):
        if node.spelling == ",":
            for part in (left, right):
                if operators.is_action(part):
                    source.change(part, [("deletion", DELETED)])
            return
        source.change(node, operators.of_binary(node, source.text, left, right))
        if node.spelling in operators.SWAPPED:
            for part in (left, right):
                source.change(part, operators.of_condition(part, source.of(part)))

    def note_name(self, node, source, text, in_table):
        if node.referenced.kind == K.ENUM_CONSTANT_DECL:
            source.change(node, operators.of_enumerator(node, text, in_table))
        elif node.spelling in self.sizes and text == node.spelling:
            source.change(node, [("constant", f"({text} + 1)"), ("constant", f"({text} - 1)")])
        elif node.spelling in operators.TWINS and node.referenced.kind in (K.FUNCTION_DECL, K.FUNCTION_TEMPLATE):
            at = node.location.offset  # of the name: what follows may be template arguments
            if source.text.startswith(node.spelling, at):
                self.twin(node, source, at)

    @staticmethod
    def twin(node, source, at):
        call = source.text[node.extent.start.offset:]
        depth, end = 0, call.index("(")
        for end, letter in enumerate(call):
            depth += (letter == "(") - (letter == ")")
            if letter == ")" and depth == 0:
                break
        begin = node.extent.start.offset
        changed = source.text[begin:at] + operators.TWINS[node.spelling] + \
            source.text[at + len(node.spelling):begin + end + 1]
        have = source.changes.setdefault((begin, begin + end + 1, False), [])
        if ("arithmetic", changed) not in have:
            have.append(("arithmetic", changed))

    def note_return(self, node, source, value, function):
        if function is None:
            return  # of a template: its type is not known
        is_lambda = function.kind == K.LAMBDA_EXPR
        result = operators.bare(value).type if is_lambda else function.result_type
        for name, changed in operators.of_return(value, source.of(value), result):
            if changed is not None:
                source.change(value, [(name, changed)])
            elif not is_lambda:
                source.change(node, [(name, "return {};")], statement=True)

    def note_parts(self, node, source, children):
        """Statements that can be left out, and conditions."""
        if node.kind in (K.IF_STMT, K.WHILE_STMT):
            children = [child for child in children if child.kind != K.DECL_STMT]  # if (Type name; condition)
            if children[0].kind == K.VAR_DECL:  # if (Type name = value): what is tested has no text of its own
                children = children[1:]
            else:
                source.change(children[0], operators.of_condition(children[0], source.of(children[0])))
            children = children[1:]
        elif node.kind in (K.FOR_STMT, K.CXX_FOR_RANGE_STMT):
            children = children[-1:]
        elif node.kind != K.COMPOUND_STMT:
            return
        for child in children:
            self.note_statement(child, source)

    @staticmethod
    def note_statement(node, source):
        if source.of(node).startswith("assert("):
            return
        leaf = operators.bare(node)
        guard = node.kind == K.IF_STMT and [part.kind for part in node.get_children()][1:] == [K.RETURN_STMT]
        is_comma = leaf.kind == K.BINARY_OPERATOR and leaf.spelling == ","
        if guard or node.kind == K.BREAK_STMT or node.kind.is_expression() and not is_comma:
            source.change(node, [("deletion", "")], statement=True)


def sizes_of(trees, sources):
    """Constants that size an array: they must stay constant, so each use of them is changed instead."""
    declared, names = {}, set()

    def look(node):
        for child in node.get_children():
            file = child.location.file
            source = sources.get(os.path.normpath(file.name)) if file else None
            if source is None:
                continue
            if child.kind in VARIABLES:
                declared[child.spelling, source.name] = child.extent.start.offset
                names.update(part.spelling for part in map(operators.bare, child.get_children())
                             if part.kind == K.DECL_REF_EXPR and part.extent.start.offset < child.location.offset)
            look(child)

    for tree in trees:
        look(tree.cursor)
    return names | {(file, begin) for (name, file), begin in declared.items() if name in names}


class Writer:
    """Renders one source with all its mutants."""

    def __init__(self, source, mutants):
        self.source, self.mutants = source, mutants
        self.sites = sorted(source.changes, key=lambda site: (site[0], -site[1], not site[2]))

    def number(self, begin, end, operator, changed):
        text, number = self.source.text, len(self.mutants) + 1
        line = text.count("\n", 0, begin) + 1
        self.mutants.append({"id": number, "file": self.source.name, "line": line, "operator": operator,
                             "text": text.splitlines()[line - 1].strip(),
                             "change": f"{' '.join(text[begin:end].split())} -> {changed or 'nothing'}"})
        return f"mutation::on({number})"

    def render(self, begin, end, sites):
        out, at = [], begin
        while sites:
            site, inner = sites[0], []
            sites = sites[1:]
            while sites and sites[0][1] <= site[1]:
                inner.append(sites[0])
                sites = sites[1:]
            out += [self.plain(at, site[0]), self.changed(site, inner)]
            at = site[1]
        return "".join(out) + self.plain(at, end)

    def changed(self, site, inner):
        begin, end, statement = site
        changes = self.source.changes[site]
        marks = [(self.number(begin, end, *change), change[1]) for change in changes]
        original = self.render(begin, end, inner)
        if statement:
            gone = "".join(f"if ({mark}) {{ {text} }} else " for mark, text in marks)
            return f"{{ {gone}{{ {original} }} }}"
        form = "void({})" if any(text == DELETED for _, text in marks) else "({})"
        if any(name == "negation" for name, _ in changes):  # a condition: what is no bool becomes one
            form = "!!({})"
        others = "".join(f"{mark} ? {form.format(text)} : " for mark, text in marks)
        return f"({others}{form.format(original)})"

    def plain(self, begin, end):
        text, swaps = self.source.text[begin:end], []
        for at, word in self.source.keywords.items():
            swaps.append((at, at + WORD_LENGTH, word))
        for (first, last), condition in self.source.asserts.items():
            swaps.append((first, last, f"inline const bool kHolds{first} = mutation::must({condition})"))
        for first, last, other in sorted(swaps, reverse=True):  # from the end: what stands before keeps its place
            if begin <= first and last <= end:
                text = text[:first - begin] + other + text[last - begin:]
        return text

    def write(self, path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text('#include "mutation.hpp"\n' + self.render(0, len(self.source.text), self.sites))


def main(root, out, generated, canary=None, *files):
    names = sorted(map(str, files or (path.relative_to(root) for path in (root / "safety").rglob("*.?pp"))))
    sources = {os.path.normpath(root / name): Source(root, name) for name in names}
    headers = "".join(f'#include "{name}"\n' for name in names if name.endswith(".hpp"))
    arguments = ["-std=c++20", f"-I{root}", f"-I{generated}", "-isystem/usr/include/eigen3"]
    trees = [Index.create().parse("headers.cpp", arguments, [("headers.cpp", headers)])]
    trees += [Index.create().parse(str(root / name), arguments) for name in names if name.endswith(".cpp")]
    for tree in trees:
        if errors := [str(problem) for problem in tree.diagnostics if problem.severity >= 3]:
            sys.exit("error: the sources do not parse: " + errors[0])
    sizes = sizes_of(trees, sources)
    for tree in trees:
        Finder(sources, sizes, bool(files)).walk(tree.cursor)
    mutants = []
    for source in sources.values():
        Writer(source, mutants).write(out / "mutated" / source.name)
    for mutant in mutants:
        if mutant["operator"] == "deletion" and mutant["text"] == f"{canary};":
            mutant["operator"] = "canary"
    (out / "mutants.json").write_text(json.dumps(mutants, indent=0))


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), *map(Path, sys.argv[2:4]), *sys.argv[4:])
