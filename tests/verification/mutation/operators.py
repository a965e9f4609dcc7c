"""What is changed: for one node of the syntax tree, the texts that may stand in its place."""

from clang.cindex import CursorKind as K, TypeKind

RELATIONAL = ["<", "<=", ">", ">=", "==", "!="]
SWAPPED = {"&&": ["||"], "||": ["&&"]}
ARITHMETIC = {"+": ["-"], "-": ["+"], "*": ["/", "+"], "/": ["*"], "%": ["/"], "&": ["|"], "|": ["&"], "^": ["|"],
              "<<": [">>"], ">>": ["<<"], "+=": ["-=", "="], "-=": ["+=", "="], "|=": ["&=", "="], "&=": ["|=", "="]}
TWINS = {"min": "max", "max": "min", "min_element": "max_element", "max_element": "min_element"}
WRAPPERS = (K.UNEXPOSED_EXPR, K.PAREN_EXPR)
SIGNED, UNSIGNED = (TypeKind.INT, TypeKind.LONG), (TypeKind.UINT, TypeKind.ULONG)
SAME_FOR_UNSIGNED_AND_ZERO = {("!=", ">"), (">", "!="), ("==", "<="), ("<=", "==")}


def bare(node):
    """The expression inside parentheses and implicit conversions."""
    while node.kind in WRAPPERS:
        children = [child for child in node.get_children() if child.kind.is_expression()]
        if len(children) != 1:
            return node
        node = children[0]
    return node


def type_of(node):
    return bare(node).type.get_canonical().kind


def is_action(node):
    """Whether an operand of a comma is there for what it does."""
    leaf = bare(node)
    return leaf.kind in (K.CALL_EXPR, K.COMPOUND_ASSIGNMENT_OPERATOR, K.UNARY_OPERATOR) or \
        leaf.kind == K.BINARY_OPERATOR and leaf.spelling == "="


def of_binary(node, text, left, right):
    """(operator, changed text) of a binary operation; nothing for one that the compiler made up."""
    written = node.spelling
    between = text[left.extent.end.offset:right.extent.start.offset]
    if written not in between or written == "-" and type_of(left) == type_of(right) == TypeKind.POINTER:
        return  # what lies between two pointers is no sum
    if written in RELATIONAL:
        others = RELATIONAL if type_of(left) in SIGNED + UNSIGNED else ["==", "!="]
        if type_of(left) in UNSIGNED and text[right.extent.start.offset:right.extent.end.offset] == "0":
            others = [other for other in others if (written, other) not in SAME_FOR_UNSIGNED_AND_ZERO]
        name = "relational"
    elif written in SWAPPED:
        name, others = "logical", SWAPPED[written]
    else:
        name, others = "arithmetic", ARITHMETIC.get(written, [])
    source = lambda part: text[part.extent.start.offset:part.extent.end.offset]
    for other in others:
        if other != written:
            yield name, source(left) + between.replace(written, other, 1) + source(right)


def of_unary(node, source):
    if source.startswith("!") and not source.startswith("!="):  # != made of == by the compiler
        yield "negation", f"({source[1:]})"
    elif source.startswith("-"):
        yield "arithmetic", f"({source[1:]})"
    elif source.startswith("++"):
        yield "arithmetic", "--" + source[2:]


def of_condition(node, source):
    """Negates the leaf of a condition; what has an operator of its own is changed there."""
    leaf = bare(node)
    has_own = leaf.kind == K.BINARY_OPERATOR and (leaf.spelling in RELATIONAL or leaf.spelling in SWAPPED)
    if not has_own and leaf.kind not in (K.UNARY_OPERATOR, K.CXX_BOOL_LITERAL_EXPR):
        yield "negation", f"!({source})"


def of_integer(source):
    digits = source.replace("'", "").rstrip("uUlL")
    value = int(digits, 8) if digits.isdigit() and digits.startswith("0") else int(digits, 0)
    for other in {value + 1, value - 1, 0} - {value}:
        yield "constant", f"({source} + 1)" if other == value + 1 else f"({source} - 1)" if other else "0"


def of_unit(source):
    """A unit that was taken for another: ms for s, um for mm."""
    yield "unit", f"({source} * 1000)"


def of_floating(source):
    if float(source.replace("'", "").rstrip("fFlL")) != 0.0:
        yield "constant", f"({source} * 1.25)"
        yield "constant", f"({source} * 0.8)"
    else:
        yield "constant", f"({source} + 1.0)"


def of_enumerator(node, source, both_neighbours):
    names = [child.spelling for child in node.referenced.semantic_parent.get_children()
             if child.kind == K.ENUM_CONSTANT_DECL]
    here = names.index(node.spelling)
    for step in [1, -1] if both_neighbours and len(names) > 2 else [1]:
        yield "constant", source[:-len(node.spelling)] + names[(here + step) % len(names)]


def of_member(node, source):
    """The next member of the same record and type, read or written in its place."""
    if node.referenced.kind != K.FIELD_DECL or not source.endswith(node.spelling):
        return
    fields = [child for child in node.referenced.semantic_parent.get_children() if child.kind == K.FIELD_DECL]
    kind = node.referenced.type.get_canonical().spelling
    same = [child.spelling for child in fields if child.type.get_canonical().spelling == kind]
    here = same.index(node.spelling) if node.spelling in same else 0
    if len(same) > 1 and node.spelling in same:
        yield "neighbour", source[:-len(node.spelling)] + same[(here + 1) % len(same)]


def of_boolean(source):
    yield "constant", "false" if source == "true" else "true"


def can_be_nothing(result):
    """Whether `return {};` compiles."""
    if result.kind == TypeKind.LVALUEREFERENCE:
        parts = list(result.get_pointee().get_canonical().get_declaration().get_children())
        made_by = [part for part in parts if part.kind == K.CONSTRUCTOR]
        is_default = not made_by or any(part.is_default_constructor() for part in made_by)
        return result.get_pointee().is_const_qualified() and is_default
    declared = result.get_canonical().get_declaration()
    parts = list(declared.get_children())
    return not any(part.kind == K.CONSTRUCTOR or
                   part.kind == K.FIELD_DECL and part.type.kind == TypeKind.LVALUEREFERENCE for part in parts)


def of_return(value, source, result):
    """(operator, changed expression, or None for `return {};`)"""
    if result.get_canonical().kind == TypeKind.BOOL:
        if bare(value).kind != K.CXX_BOOL_LITERAL_EXPR:
            yield "return value", "true"
            yield "return value", "false"
        return
    leaf = bare(value)
    is_zero = leaf.kind == K.INTEGER_LITERAL and source == "0" or source == "{}" or (
        leaf.kind == K.DECL_REF_EXPR and leaf.referenced.kind == K.ENUM_CONSTANT_DECL and
        leaf.referenced.enum_value == 0)
    if not is_zero and can_be_nothing(result):
        yield "return value", None
    if result.get_canonical().kind in SIGNED + UNSIGNED[:1] and leaf.kind != K.INTEGER_LITERAL:
        yield "return value", f"({source}) + 1"
