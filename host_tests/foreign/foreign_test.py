#!/usr/bin/env python3
"""zerorate as a guest of other people's projects: each of them builds, keeps its flags, and computes the bits of ours.

usage: foreign_test.py WAY --repository FOLDER --build FOLDER --work FOLDER

WAY is add_subdirectory, fetch_content, find_package, makefile, drop_in or compilers. The projects of this folder are copied
into the work folder, where nothing of the repository is in reach but what the way names. All play 2,000 samples of a real
recording with a drive in between (docs/examples/c/super_loop.c on board.c) and must print what this machine's
libzerorate.a of the build folder prints. Without recordings the samples are made up, and the exit code is 77.
"""

import argparse
import gzip
import json
import math
import os
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys

HERE = pathlib.Path(__file__).parent
# Debian's modules, for a Python that is not Debian's.
sys.path.append("/usr/lib/python3/dist-packages")
SAMPLES = 2000
RECORDING = "adis16405_static/run1_100hz_raw.csv.gz"
# Every compiler of Debian 12 that knows what of C++20 zerorate is written in.
COMPILERS = ("g++-11", "g++-12", "clang++-13", "clang++-14", "clang++-15", "clang++-16")

# Processor -> flags and board of QEMU. The M3 runs what an M0+ runs, and has the memory.
CORTEX = {
    "m0plus": ("-mcpu=cortex-m0plus -mthumb", "mps2-an385"),
    "m4f": ("-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard", "mps2-an386"),
    "m7": ("-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard", "mps2-an500"),
}
ARM_LINK = "-specs=nosys.specs -nostartfiles -T../app/board.ld -Wl,--gc-sections"
# Debian's compilers for RISC-V and Xtensa bring no C++ headers; those of its Arm package are of the same release.
NEWLIB = "/usr/include/newlib"
RISCV = {"rv32imac": ("ilp32", "qemu-riscv32"), "rv32imafc": ("ilp32f", "qemu-riscv32")}


class Failure(Exception):
    """What the test found."""


def run(*command, folder=None, environment=None, may_fail=False, timeout=300):
    """The standard output and error of a command."""
    done = subprocess.run([str(word) for word in command], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout)
    if done.returncode != 0 and not may_fail:
        raise Failure(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}")
    return done.stdout


def require(condition, complaint):
    if not condition:
        raise Failure(complaint)


def single(number):
    return struct.unpack("f", struct.pack("f", number))[0]


def real_samples(repository):
    """The beginning of a recording [rad/s]; None where there are no recordings."""
    folder = pathlib.Path(os.environ.get("ZERORATE_DATA", repository / "../shared/data"))
    if not folder.is_dir():
        return None
    with gzip.open(folder / RECORDING, "rt") as file:
        next(file)
        return [[math.radians(float(rate)) for rate in next(file).split(",")[1:4]] for _ in range(SAMPLES)]


def made_up_samples():
    noise = random.Random(18)
    return [[noise.gauss(bias, 0.01) for bias in (0.007, -0.008, -0.005)] for _ in range(SAMPLES)]


def cxx_headers(multilib="thumb/v6-m/nofp"):
    """Options that lend a compiler the C++ headers of Debian's Arm package."""
    root = max(pathlib.Path(NEWLIB, "c++").iterdir())
    folders = (root, root / "arm-none-eabi" / multilib, root / "arm-none-eabi", NEWLIB)
    return "-ffreestanding " + " ".join(f"-isystem {folder}" for folder in folders)


class Workshop:
    """A folder with the foreign projects, and what they must print."""

    def __init__(self, arguments):
        self.repository = arguments.repository.resolve()
        self.build = arguments.build.resolve()
        self.work = arguments.work.resolve() / arguments.way
        shutil.rmtree(self.work, ignore_errors=True)
        app = self.work / "app"
        app.mkdir(parents=True)
        for path in (*(self.repository / "docs/examples/c").glob("super_loop.*"), *HERE.glob("board.*"),
                     HERE / "figures.c", self.repository / "firmware/c_api/examples/front_gyro.h"):
            shutil.copy(path, app)
        samples = real_samples(self.repository)
        self.has_recordings = samples is not None
        rows = ("{" + ", ".join(f"{single(rate).hex()}F" for rate in row) + "},\n" for row in samples or made_up_samples())
        (app / "samples.h").write_text("".join(rows))
        self.environment = dict(os.environ)
        if shutil.which("ccache"):
            self.environment |= {"CMAKE_CXX_COMPILER_LAUNCHER": "ccache", "LAUNCHER": "ccache"}
        self.expected = self.bits_of_the_library()

    def bits_of_the_library(self, *flags):
        library = next(self.build.rglob("libzerorate.a"), None)
        require(library, f"no libzerorate.a in {self.build}")
        run("gcc", "-std=c11", "-O1", *flags, f"-I{self.repository}/firmware/c_api/include", "-I.", "super_loop.c", "board.c",
            library, "-o", "reference", folder=self.work / "app")
        printed = run(self.work / "app/reference")
        require(printed.endswith("end\n") and "heading" in printed and printed.count("\n") == 103,
                f"the library itself: {printed}")
        return printed

    def project(self, name):
        """A copy of a project of this folder."""
        return shutil.copytree(HERE / name, self.work / name, dirs_exist_ok=True)

    def compare(self, what, printed):
        require(printed == self.expected, f"{what}: other bits than the library:\n{printed}")
        print(f"{what}: the bits of the library", flush=True)

    def run_on(self, processor, image):
        return run("qemu-system-arm", "-M", CORTEX[processor][1], "-display", "none", "-monitor", "none", "-serial", "null",
                   "-semihosting-config", "enable=on,target=native", "-kernel", image)

    def toolchain(self, processor):
        """A toolchain file as a firmware project has it: with the C library, without -ffreestanding."""
        flags = CORTEX[processor][0]
        path = self.work / f"{processor}.cmake"
        path.write_text(f"""set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
set(CMAKE_C_FLAGS_INIT "{flags} -ffunction-sections")
set(CMAKE_CXX_FLAGS_INIT "{flags} -ffunction-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "{ARM_LINK.replace('../app', str(self.work / 'app'))}")
""")
        return path

    def cmake(self, project, name, *options, processor=None):
        """Configures, builds everything and runs a project; gives its build folder."""
        build = self.work / f"build-{name}"
        if processor:
            options = (*options, "--toolchain", self.toolchain(processor))
        run("cmake", "-S", project, "-B", build, "-G", "Ninja", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options,
            environment=self.environment)
        said = run("cmake", "--build", build, environment=self.environment)
        require("warning" not in said, f"{name}: {said}")
        program = build / "firmware"
        self.compare(name, self.run_on(processor, program) if processor else run(program))
        return build

    def make(self, name, *variables):
        """Builds a copy of the project of make alone; gives its folder."""
        folder = shutil.copytree(HERE / "makefile", self.work / name)
        run("make", "--no-print-directory", *variables, folder=folder, environment=self.environment)
        return folder


def check_guest(build):
    """The project around keeps its flags and its tests, and nothing is asked of its machine."""
    commands = json.loads((build / "compile_commands.json").read_text())
    own = [entry["command"] for entry in commands if "/app/" in entry["file"]]
    require(len(own) == 2, f"{build}: {len(own)} files of its own")
    for flag in ("-Werror", "-Wconversion", "-ffp-contract", "-fno-math-errno", "-fno-exceptions"):
        require(not any(flag in command for command in own), f"{build}: {flag} reaches the guest's files")
    require(len(commands) - len(own) <= 3, f"{build}: more than the library is compiled: {commands}")
    cache = (build / "CMakeCache.txt").read_text()
    asked = re.findall(r"^(?:_?Python3|GTest|Boost|Eigen3|CLI11|libgpiod|fmt|ZERORATE_NM|BUILD_TESTING)\w*", cache, re.MULTILINE)
    require(not asked, f"{build}: asked of the machine: {asked}")


def add_subdirectory(shop):
    project = shop.project("add_subdirectory")
    given = f"-DZERORATE={shop.repository}"
    build = shop.cmake(project, "add_subdirectory-gcc-debug", given, "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_COMPILER=gcc",
                       "-DCMAKE_CXX_COMPILER=g++")
    check_guest(build)
    require("Total Tests: 1\n" in run("ctest", "-N", folder=build), "tests that are not the guest's")
    shop.cmake(project, "add_subdirectory-m0plus", given, "-DCMAKE_BUILD_TYPE=MinSizeRel", processor="m0plus")


def fetch_content(shop):
    project = shop.project("fetch_content")
    given = f"-DFETCHCONTENT_SOURCE_DIR_ZERORATE={shop.repository}"
    shop.cmake(project, "fetch_content-clang", given, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_C_COMPILER=clang",
               "-DCMAKE_CXX_COMPILER=clang++")
    check_guest(shop.cmake(project, "fetch_content-m7", given, "-DCMAKE_BUILD_TYPE=Release", processor="m7"))


def find_package(shop):
    project = shop.project("find_package")
    for name, build, processor in (("host", shop.build, None),
                                   ("m4f", shop.repository / "build/mcu-cortex-m4f", "m4f")):
        prefix = shop.work / f"installed-{name}"
        run("cmake", "--install", build, "--component", "library", "--prefix", prefix)
        beside = sorted(path.name for path in (prefix / "include").iterdir())
        require(beside == ["zerorate", "zerorate.h", "zerorate_references.h", "zerorate_size.h"], f"include root: {beside}")
        shop.cmake(project, f"find_package-{name}", f"-DCMAKE_PREFIX_PATH={prefix}",
                   f"-Dzerorate_DIR={next(prefix.rglob('zerorateConfig.cmake')).parent}", processor=processor)
    said = run("cmake", "-S", project, "-B", shop.work / "wrong", f"-DCMAKE_PREFIX_PATH={prefix}", may_fail=True)
    require("zerorate with the toolchain file of your" in " ".join(said.split()), f"a wrong package is not told: {said}")


def makefile(shop):
    given = f"ZERORATE={shop.repository}"
    shop.compare("program with -fshort-enums", shop.bits_of_the_library("-fshort-enums"))
    for level in ("-Os", "-O3"):  # whose defaults contract to fused multiply-add
        folder = shop.make(f"makefile-m4f{level}", given, "CROSS=arm-none-eabi-", f"CPU={CORTEX['m4f'][0]}",
                           f"LINK={ARM_LINK}", f"OPTIMISATION={level}")
        shop.compare(f"makefile-m4f{level}", shop.run_on("m4f", folder / "firmware"))
        listing = run("arm-none-eabi-objdump", "-d", folder / "zerorate.o")
        require("vsqrt" in listing, "no square root in the library")
        require(not re.search(r"vf[nm]?ma|vfms", listing), "fused multiply-add in the library")
        wanted = set(re.findall(r"U (\S+)", run("arm-none-eabi-nm", "-u", folder / "zerorate.o")))
        require(wanted <= {"memcpy", "memset", "memmove", "__aeabi_ldivmod", "_ZN8zerorate4core16assertion_failedEPKci"},
                f"wanted of others: {wanted}")
    source = shop.repository / "firmware/c_api/zerorate.cpp"
    for flag in ("-ffast-math", "-Ofast", "-ffinite-math-only", "-fassociative-math -fno-signed-zeros -fno-trapping-math"):
        said = run("g++", "-std=c++20", *flag.split(), f"-I{shop.repository}", "-fsyntax-only", source, may_fail=True)
        require("changes what zerorate computes" in said, f"{flag} is not refused: {said}")
    for architecture, (abi, emulator) in RISCV.items():
        folder = shop.make(f"makefile-{architecture}", given, "CROSS=riscv64-unknown-elf-",
                           f"CPU=-march={architecture} -mabi={abi} {cxx_headers()}",
                           "LINK=-nostdlib -lgcc -Wl,--no-relax -Wl,--no-warn-rwx-segments")
        shop.compare(f"makefile-{architecture}", run(emulator, folder / "firmware"))
    # Compiled only: Debian's libgcc for the lx106 lacks the software floating point, which is in that chip's ROM.
    folder = shutil.copytree(HERE / "makefile", shop.work / "makefile-xtensa")
    run("make", given, "CROSS=xtensa-lx106-elf-", f"CPU=-mlongcalls {cxx_headers()}", "zerorate.o", "assert.o", "super_loop.o",
        folder=folder, environment=shop.environment)
    require("Tensilica Xtensa" in run("xtensa-lx106-elf-readelf", "-h", folder / "zerorate.o"), "no object for Xtensa")
    print("makefile-xtensa: compiles; not linked")


def made_drop_in(shop):
    folder = shop.work / "drop_in"
    run(sys.executable, "-B", shop.repository / "toolchains/package/amalgamate.py", folder)
    return folder


def tokens(shop, name, source):
    """What the compiler makes of a source before it parses it, without the places of assertions."""
    path = shop.work / f"{name}.i"
    run("g++", "-std=c++20", "-E", "-P", "-w", "-D__FILE__=0", "-D__LINE__=0", f"-I{shop.repository}", source, "-o", path)
    return path.read_text().split()


def check_manifests(drop_in):
    """What the four makers' documentation demands, as far as it can be checked without their tools."""
    platformio = json.loads((drop_in / "library.json").read_text())
    version = re.search(r"project\(zerorate VERSION (\S+)", (HERE / "../../CMakeLists.txt").read_text())[1]
    require(re.fullmatch(r"[\w+.-]{1,100}", platformio["name"]) and platformio["version"] == version and
            re.fullmatch(r"\d+\.\d+\.\d+", version), "library.json: name, version")
    require(len(platformio["description"]) <= 255 and isinstance(platformio["keywords"], list), "library.json: description")
    require(all(re.fullmatch(r"[a-z0-9 -]{1,50}", word) for word in platformio["keywords"]), "library.json: keywords")
    require("arduino" not in platformio["frameworks"] and "*" not in platformio["platforms"], "library.json: frameworks, platforms")
    require((drop_in / platformio["build"]["srcDir"] / platformio["headers"]).is_file(), "library.json: headers")
    known = {"name", "version", "description", "keywords", "license", "headers", "frameworks", "platforms", "build"}
    require(set(platformio) == known, f"library.json: {set(platformio) ^ known}")

    lines = (drop_in / "library.properties").read_text().splitlines()
    arduino = dict(line.split("=", 1) for line in lines)
    require(not {"avr", "*"} & set(arduino["architectures"].split(",")), "library.properties: architectures")
    demanded = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures", "includes"}
    require(set(arduino) == demanded and all(arduino.values()), f"library.properties: {set(arduino) ^ demanded}")
    require(re.fullmatch(r"[A-Za-z0-9][\w .-]{0,62}", arduino["name"]) and arduino["version"] == version,
            "library.properties: name, version")
    require(arduino["category"] in ("Display", "Communication", "Signal Input/Output", "Sensors", "Device Control", "Timing",
                                    "Data Storage", "Data Processing", "Other"), "library.properties: category")

    import yaml
    component = yaml.safe_load((drop_in / "idf_component.yml").read_text())
    require(component["version"] == version and component["dependencies"]["idf"].startswith(">="), "idf_component.yml")
    module = yaml.safe_load((drop_in / "zephyr/module.yml").read_text())
    require(module["name"] == "zerorate" and (drop_in / module["build"]["kconfig"]).is_file() and
            (drop_in / module["build"]["cmake"] / "CMakeLists.txt").is_file(), "zephyr/module.yml")
    check_kconfig(drop_in)


def check_kconfig(drop_in):
    """The options of Zephyr that ours stands on are played."""
    import kconfiglib
    (tree := drop_in / "Kconfig.of_a_tree").write_text(
        'config STD_CPP20\n\tbool "C++20"\nconfig REQUIRES_FULL_LIBCPP\n\tbool\n' f'source "{drop_in}/zephyr/Kconfig"\n')
    os.environ["KCONFIG_STRICT"] = "y"
    kconfig = kconfiglib.Kconfig(str(tree), warn_to_stderr=False)
    kconfig.syms["ZERORATE"].set_value(2)
    require(kconfig.syms["ZERORATE"].str_value == "n", "Kconfig: without C++20")
    kconfig.syms["STD_CPP20"].set_value(2)
    for count in ("12", "4", "1"):
        for name in ("ZERORATE", f"ZERORATE_HYPOTHESES_{count}"):
            kconfig.syms[name].set_value(2)
        chosen = [kconfig.syms[name].str_value for name in ("ZERORATE", "REQUIRES_FULL_LIBCPP", "ZERORATE_HYPOTHESES")]
        require(chosen == ["y", "y", count] and not kconfig.warnings, f"Kconfig: {chosen} {kconfig.warnings}")


# Projects that play what ESP-IDF and Zephyr do with the folder, and a plain one: name -> lines of their CMakeLists.txt.
HOSTS = {
    "cmake": 'add_subdirectory("${DROP_IN}" drop_in)\nset(library zerorate::c)\n',
    "esp_idf": """set(ESP_PLATFORM ON)
macro(idf_component_register)
  cmake_parse_arguments(component "" "" "SRCS;INCLUDE_DIRS" ${ARGN})
  set(COMPONENT_LIB component_zerorate)
  add_library(component_zerorate STATIC ${component_SRCS})
  target_include_directories(component_zerorate PUBLIC ${component_INCLUDE_DIRS})
endmacro()
add_subdirectory("${DROP_IN}" drop_in)
set(library component_zerorate)
""",
    "zephyr": """set(CONFIG_ZERORATE y)
set(CONFIG_ZERORATE_HYPOTHESES 12)
set(CMAKE_CXX_STANDARD 20)
macro(zephyr_library_named name)
  add_library(${name} STATIC)
endmacro()
macro(zephyr_library_sources)
  target_sources(zerorate PRIVATE ${ARGN})
endmacro()
macro(zephyr_library_compile_options)
  target_compile_options(zerorate PRIVATE ${ARGN})
endmacro()
macro(zephyr_include_directories)
  include_directories(${ARGN})
  target_include_directories(zerorate PUBLIC ${ARGN})
endmacro()
macro(zephyr_compile_definitions)
  target_compile_definitions(zerorate PUBLIC ${ARGN})
endmacro()
add_subdirectory("${DROP_IN}/zephyr" drop_in)
set(library zerorate)
""",
}


def drop_in(shop):
    folder = made_drop_in(shop)
    both = shop.work / "both.cpp"
    both.write_text('#include "firmware/c_api/zerorate.cpp"\n#include "core/base/assert.cpp"\n')
    ours, theirs = tokens(shop, "library", both), tokens(shop, "drop_in", folder / "src/zerorate.cpp")
    require(ours == theirs, "the file to drop in has other tokens than the library")
    print(f"zerorate.cpp: the library's {len(ours)} words of preprocessed text, no other")
    check_manifests(folder)
    print("manifests: as their makers demand")
    made = shop.make("drop_in-m4f", f"DROP_IN={folder}/src", "CROSS=arm-none-eabi-", f"CPU={CORTEX['m4f'][0]}",
                     f"LINK={ARM_LINK}", "OPTIMISATION=-O2")
    shop.compare("drop_in-m4f", shop.run_on("m4f", made / "firmware"))
    for name, lines in HOSTS.items():
        project = shop.work / f"host-{name}"
        project.mkdir()
        languages = "C CXX" if name != "cmake" else "C"
        (project / "CMakeLists.txt").write_text(
            f"cmake_minimum_required(VERSION 3.16)\nproject(host LANGUAGES {languages})\n{lines}"
            "add_executable(firmware ../app/super_loop.c ../app/board.c)\n"
            "target_include_directories(firmware PRIVATE ../app)\n"
            "target_link_libraries(firmware PRIVATE ${library})\n")
        shop.cmake(project, f"drop_in-{name}", f"-DDROP_IN={folder}", "-DCMAKE_BUILD_TYPE=Release")


def compilers(shop):
    """Every compiler that is installed makes the same bits of the file to drop in; those that are not are named."""
    folder = made_drop_in(shop)
    found = [name for name in COMPILERS if shutil.which(name)]
    require(len(found) >= 2, f"only {found} of {COMPILERS}")
    for name in found:
        made = shop.make(name, f"DROP_IN={folder}/src", f"CXX={name}", "CPU=-fPIE", "OPTIMISATION=-O2")
        shop.compare(f"{name} {run(name, '-dumpfullversion', '-dumpversion').split()[0]}", run(made / "firmware"))
    for name in COMPILERS:
        if name not in found:
            print(f"{name}: not installed here")


WAYS = {way.__name__: way for way in (add_subdirectory, fetch_content, find_package, makefile, drop_in, compilers)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("way", choices=WAYS)
    for name in ("repository", "build", "work"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    try:
        shop = Workshop(arguments)
        WAYS[arguments.way](shop)
    except Failure as failure:
        sys.exit(f"{arguments.way}: {failure}")
    if not shop.has_recordings:
        print("skipped: no recordings; made-up samples gave the library's bits")
        sys.exit(77)


if __name__ == "__main__":
    main()
