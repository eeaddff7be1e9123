#!/usr/bin/env python3
"""Packs the built package into a wheel, for the interpreter that runs this program.

usage: wheel.py PACKAGE --version VERSION --output FOLDER

A wheel is a zip file with METADATA, WHEEL and RECORD (PEP 427); no tool of the Python world is needed for it. Its bytes
depend on the package's alone. Prints the path.
"""

import argparse
import base64
import hashlib
import pathlib
import sysconfig
import zipfile

MOMENT = (2020, 1, 1, 0, 0, 0)  # of every file, so that equal packages make equal wheels


def metadata(version):
    return (f"Metadata-Version: 2.1\nName: zerorate\nVersion: {version}\n"
            "Summary: Bias prediction for MEMS gyroscopes\nLicense: Apache-2.0\n"
            "Requires-Python: >=3.11\nRequires-Dist: numpy\nProvides-Extra: plot\n"
            'Requires-Dist: matplotlib; extra == "plot"\n')


def tag():
    version = sysconfig.get_config_var("py_version_nodot")
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"cp{version}-cp{version}-{platform}"


def record_line(name, content):
    digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
    return f"{name},sha256={digest},{len(content)}\n"


def pack(package, version, folder):
    """Writes the wheel and returns its path."""
    suffixes = {".py", ".pyi", ".typed", ".so"}
    files = {f"zerorate/{path.name}": path.read_bytes() for path in sorted(package.iterdir()) if path.suffix in suffixes}
    info = f"zerorate-{version}.dist-info"
    files[f"{info}/METADATA"] = metadata(version).encode()
    files[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: zerorate\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    record = "".join(record_line(name, content) for name, content in files.items()) + f"{info}/RECORD,,\n"
    files[f"{info}/RECORD"] = record.encode()
    wheel = folder / f"zerorate-{version}-{tag()}.whl"
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)
    return wheel


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("package", type=pathlib.Path)
    parser.add_argument("--version", required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    print(pack(arguments.package, arguments.version, arguments.output))


if __name__ == "__main__":
    main()
