"""The declared types, by a program that gives every option."""

import ast
import inspect
import os
import subprocess
import sys
from pathlib import Path

import marching_particles as mp

PROGRAM = Path(__file__).with_name("program.py")


STUB = Path(mp.__file__).with_name("__init__.pyi")


def test_remesh_takes_what_sample_takes_except_for_the_options_of_other_fields():
    stub = ast.parse(STUB.read_text(encoding="utf-8"))
    functions = {node.name: node.args for node in stub.body if isinstance(node, ast.FunctionDef)}
    types = {
        name: {own.arg: ast.unparse(own.annotation) for own in arguments.kwonlyargs}
        for name, arguments in functions.items()
    }
    of_others = {"params", "gradient", "closed", "periodic", "thickness"}
    wanted = {name: kind for name, kind in types["sample"].items() if name not in of_others}
    assert wanted.items() <= types["remesh"].items()
    assert types["remesh"].keys() - wanted.keys() == {"edges", "borders", "smooth", "lines"}
    assert functions["remesh"].kwarg is None


def test_a_program_with_every_option_passes_a_strict_checker():
    calls = [node for node in ast.walk(ast.parse(PROGRAM.read_text())) if isinstance(node, ast.Call)]
    for function in (mp.sample, mp.fit_points, mp.remesh):
        given = {
            keyword.arg
            for call in calls
            if getattr(call.func, "attr", None) == function.__name__
            for keyword in call.keywords
        }
        options = inspect.signature(function).parameters.values()
        assert {own.name for own in options if own.kind is own.KEYWORD_ONLY} <= given
    checker = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, str(PROGRAM)]
    run = subprocess.run(checker, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
