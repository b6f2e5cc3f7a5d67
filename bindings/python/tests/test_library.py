"""The package and the C library belong together: structs, functions, versions; one line where they do not."""

import ctypes
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from support import PACKAGE, run_python

import knurl
from knurl import _library, _structs

HEADERS = os.path.join(PACKAGE, "..", "..", "runtime", "capi", "include")
TYPES = {"uint64_t": ctypes.c_uint64, "int64_t": ctypes.c_int64, "uint32_t": ctypes.c_uint32, "double": ctypes.c_double,
         "knurl_vec3": _structs.Vec3, "knurl_quat": _structs.Quat, "knurl_report": _structs.ReportRow,
         "knurl_asset_material": _structs.AssetMaterialRow}


def header(name):
    with open(os.path.join(HEADERS, name), encoding="utf-8") as file:
        return re.sub(r"//[^\n]*", "", file.read())


def members_of(body):
    """(name, ctypes type) of a struct's declarations."""
    for declaration in filter(None, (part.strip() for part in body.split(";"))):
        kind, pointer, name, count = re.fullmatch(r"(?:const )?(\w+)(\*?) (\w+)(?:\[(\d+)\])?", declaration).groups()
        if pointer:
            yield name, ctypes.c_char_p if kind == "char" else ctypes.c_void_p
        elif kind == "char":
            yield name, ctypes.c_char * int(count)
        else:
            yield name, TYPES[kind] * int(count) if count else TYPES[kind]


class Header(unittest.TestCase):
    def test_structs_are_those_of_the_header(self):
        ours = {kind.__doc__: kind for kind in vars(_structs).values()
                if isinstance(kind, type) and issubclass(kind, ctypes.Structure) and kind.__doc__.startswith("knurl_")}
        found = 0
        for name in ("knurl.h", "knurl_offline.h"):
            for struct, body in re.findall(r"typedef struct (\w+) \{(.*?)\}", header(name), re.S):
                if struct in ("knurl_vec3", "knurl_quat"):
                    continue
                with self.subTest(struct=struct):
                    self.assertEqual([(member, ctypes.sizeof(kind)) for member, kind in members_of(body)],
                                     [(member, ctypes.sizeof(kind)) for member, kind in ours[struct]._fields_])
                    found += 1
        self.assertEqual(found, len(ours))

    def test_every_function_of_the_headers_is_bound(self):
        for name, bound in (("knurl.h", _library._ARGUMENTS), ("knurl_offline.h", _library._OFFLINE_ARGUMENTS)):
            declared = re.findall(r"KNURL_API[\w\s*]*?\b(knurl_\w+)\(([^;]*)\);", header(name))
            self.assertEqual({function for function, _ in declared}, set(bound))
            for function, arguments in declared:
                count = 0 if arguments.strip() == "void" else arguments.count(",") + 1
                self.assertEqual(len(bound[function]), count, function)

    def test_codes_are_those_of_the_header(self):
        codes = {name: int(number) for name, number in re.findall(r"KNURL_(\w+) = (-\d+)", header("knurl.h"))}
        ours = {re.sub(r"(?<=[a-z])(?=[A-Z])", "_", kind.__name__).upper(): kind.code for kind in knurl.Error.__subclasses__()}
        self.assertEqual(ours, codes)


class Versions(unittest.TestCase):
    """A copy of the package, altered, beside the same library."""

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copytree(os.path.dirname(knurl.__file__), os.path.join(self.folder, "knurl"))

    def altered(self, name, before, after):
        path = os.path.join(self.folder, "knurl", name)
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.assertRegex(text, before)
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub(before, after, text, count=1))

    def last_line_of_import(self, **more):
        done = run_python("import knurl", env=dict(os.environ, PYTHONPATH=self.folder, **more))
        self.assertEqual(done.returncode, 1)
        return done.stderr.strip().splitlines()[-1]

    def test_another_version(self):
        self.altered("_version.py", r'"[\d.]+"', '"9.9.9"')
        self.assertRegex(self.last_line_of_import(), r"Incompatible: libknurl.so.0 is of version [\d.]+, the Python package knurl of 9.9.9; install both")

    def test_other_representations(self):
        self.altered("_kinds.py", r"LAYOUT = 0x\w+", "LAYOUT = 0x1")
        self.assertIn("their representations differ", self.last_line_of_import())

    def test_other_structs(self):
        self.altered("_structs.py", r'\("key_file", c.c_char_p\),', '("key_file", c.c_char_p), ("more", c.c_char_p),')
        self.assertIn("for knurl_connect_options; install both of one version", self.last_line_of_import())

    def test_no_library(self):
        self.assertRegex(self.last_line_of_import(KNURL_LIBRARY_DIR="/nowhere"),
                         "ImportError: /nowhere/libknurl.so.0 cannot be loaded .* set KNURL_LIBRARY_DIR")

    def test_another_library_of_that_name(self):
        shutil.copy(os.path.join(os.environ["KNURL_LIBRARY_DIR"], "libknurl-offline.so.0"), os.path.join(self.folder, "libknurl.so.0"))
        line = self.last_line_of_import(KNURL_LIBRARY_DIR=self.folder)
        self.assertRegex(line, "ImportError: .*libknurl.so.0 has no knurl_")

    def test_the_tables_give_the_same_file_twice(self):
        path = os.path.join(self.folder, "again.py")
        library = os.path.join(os.environ["KNURL_LIBRARY_DIR"], "libknurl.so.0")
        subprocess.run([sys.executable, os.path.join(PACKAGE, "generate_kinds.py"), library, path], check=True)
        with open(path, encoding="utf-8") as one, open(os.path.join(self.folder, "knurl", "_kinds.py"), encoding="utf-8") as other:
            self.assertEqual(one.read(), other.read())


class Import(unittest.TestCase):
    def test_numpy_and_asyncio_come_when_they_are_needed(self):
        done = run_python("import sys, knurl; print([m for m in ('numpy', 'asyncio', 'subprocess', 'matplotlib') if m in sys.modules])")
        self.assertEqual((done.stdout.strip(), done.stderr), ("[]", ""))

    def test_all_names_are_there(self):
        for name in knurl.__all__:
            self.assertTrue(hasattr(knurl, name), name)
        with self.assertRaisesRegex(AttributeError, "has no attribute 'nonsense'"):
            knurl.nonsense


if __name__ == "__main__":
    unittest.main()
