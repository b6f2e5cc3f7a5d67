"""Runs a notebook's cells as a script, where there is no nbconvert: run_notebook.py 09_notebook.ipynb"""
import ast
import json
import sys


def run(path):
    """Executes every code cell, and prints the value of its last expression, as a notebook shows it."""
    with open(path, encoding="utf-8") as file:
        cells = json.load(file)["cells"]
    names = {"__name__": "__main__"}
    for number, cell in enumerate(cells):
        if cell["cell_type"] != "code":
            continue
        body = ast.parse("".join(cell["source"]), f"{path}, cell {number}")
        last = body.body.pop() if isinstance(body.body[-1], ast.Expr) else None
        exec(compile(body, f"{path}, cell {number}", "exec"), names)
        if last is not None:
            value = eval(compile(ast.Expression(last.value), f"{path}, cell {number}", "eval"), names)
            if value is not None:
                print(value)


if __name__ == "__main__":
    run(sys.argv[1])
