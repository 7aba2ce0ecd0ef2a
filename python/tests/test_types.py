"""The stubs name what there is, and everything public says what it is."""

import ast
from pathlib import Path

import pt_renderer
from pt_renderer import _native

PACKAGE = Path(pt_renderer.__file__).parent
STUBS = ast.parse((PACKAGE / "_native.pyi").read_text(encoding="utf-8"))


def public(names):
    return {name for name in names if not name.startswith("__")}


def test_stubs_have_the_members_of_the_classes():
    classes = {node.name: node for node in STUBS.body if isinstance(node, ast.ClassDef) and node.name != "Method"}
    assert classes.keys() == {name for name, value in vars(_native).items() if isinstance(value, type)}
    for name, node in classes.items():
        stubs = {member.name for member in node.body if isinstance(member, ast.FunctionDef)}
        assert public(stubs) == public(vars(getattr(_native, name))), name


def test_stubs_have_the_parameters_of_the_functions():
    def parameters(node):
        found = [argument.arg for argument in node.args.args + node.args.kwonlyargs]
        return [name for name in found if name not in ("self", "cls")]

    nodes = [(_native, node) for node in STUBS.body if isinstance(node, ast.FunctionDef) and not node.name.startswith("_")]
    for name in ("Scene", "Picture"):
        (group,) = [node for node in STUBS.body if isinstance(node, ast.ClassDef) and node.name == name]
        nodes += [(getattr(_native, name), node) for node in group.body if isinstance(node, ast.FunctionDef) and not node.decorator_list]
    for owner, node in nodes:
        text = getattr(getattr(owner, node.name), "__text_signature__", None)
        if text and not node.name.startswith("_"):
            told = [word.split("=")[0].strip() for word in text.strip("()").split(",")]
            assert parameters(node) == [word for word in told if word not in ("$self", "*", "/", "")], node.name


def test_everything_is_described():
    for name in pt_renderer.__all__:
        value = getattr(pt_renderer, name)
        assert value.__doc__, name
        members = public(vars(value)) if isinstance(value, type) and value.__module__ != "pt_renderer._values" else ()
        assert all(getattr(value, member).__doc__ for member in members if not member.startswith("_")), name
    assert (PACKAGE / "py.typed").exists()
