#!/usr/bin/env python3
"""Makes the C interface one source file with its headers to drop into a project, with manifests around them.

usage: amalgamate.py OUTPUT_FOLDER

zerorate.cpp is firmware/c_api/zerorate.cpp, core/base/assert.cpp and every header that they include, each once and in
the order in which the compiler reads them; not a token is different (host_tests/foreign/foreign_test.py). The folder is
at the same time a library for PlatformIO, Arduino, Zephyr and ESP-IDF, and a folder for add_subdirectory().
"""

import json
import pathlib
import re
import sys

REPOSITORY = pathlib.Path(__file__).parents[2]
SOURCES = ("firmware/c_api/zerorate.cpp", "core/base/assert.cpp")
INCLUDE_FOLDER = "firmware/c_api/include"
SKETCH = "docs/examples/arduino/heading"
HEADERS = ("zerorate.h", "zerorate_references.h", "zerorate_size.h")
INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)[">]')

DESCRIPTION = "Predicts the bias of a MEMS gyroscope between standstills, with its error; C interface, no heap"

README = """# zerorate {version}, to drop in

`src/zerorate.h` and `src/zerorate.cpp` are the C interface of zerorate, made from its repository by
`toolchains/package/amalgamate.py`: change them there. Compile `zerorate.cpp` as C++20; it needs the headers of a C++
library, and links with neither a C++ library nor a maths library. `-fno-exceptions -fno-rtti -fno-threadsafe-statics`
keep it free of calls into a C++ run time. `-DZERORATE_HYPOTHESES=4` (or 1) for the library and all that includes the header
makes an instance smaller.

| way | files | tested | not tested |
|---|---|---|---|
| any build | `src` | compiled by GCC 11, 12 and clang 13 to 16; Cortex-M4F and this machine: bits of the library | |
| CMake | `CMakeLists.txt` | `add_subdirectory()`, target `zerorate::c` | |
| PlatformIO | `library.json` | the fields against what its documentation demands | a build by PlatformIO: not built here |
| Arduino | `library.properties`, `examples/heading` | the sketch by Debian's arduino-builder on a core of the test, which runs it over a wrap of `micros()` | a build with a core of a maker: not built here |
| Zephyr | `zephyr/` | Kconfig by kconfiglib, CMake with stand-ins for Zephyr's functions | a build in a Zephyr tree: not built here |
| ESP-IDF | `idf_component.yml`, `CMakeLists.txt` | YAML, CMake with a stand-in for `idf_component_register()` | a build by ESP-IDF: not built here |

## Targets

The compiler decides: GCC 11 or clang 13 and later, as C++20, with the headers of a C++ library, `int` of 32 bits. No target of
this list was built with its maker's tools; Arm Cortex-M, RISC-V (both run in emulators) and Xtensa (an object) were compiled with
Debian's GCC 12. The versions are those of the makers' release notes and package lists:

| target | compiler |
|---|---|
| ESP-IDF 5.0 and later | GCC 11.2 and later |
| Arduino, Espressif's core for the ESP32, 3.0 and later | GCC 12.2 and later |
| Arduino, that core before 3.0; PlatformIO's own `espressif32` with the framework `arduino` | no: GCC 8.4. In PlatformIO take the platform `pioarduino`, which has core 3 |
| Arduino, Philhower's core for RP2040 and RP2350, 3.4 and later | GCC 12.3 and later |
| Arduino, ST's core for STM32, 2.5 and later | GCC 12.2 and later |
| Arduino's own cores for SAMD and RP2040 (Mbed) | no: GCC 7.2 |
| Arduino, Adafruit's core for the nRF52 | no: GCC 9 |
| PlatformIO, `ststm32` and `nordicnrf52` | older than GCC 11 in the versions seen: name a newer `toolchain-gccarmnoneeabi` in `platform_packages` |
| AVR (Uno, Nano, Mega) | no: no C++ library, 2 KiB of RAM |
| ESP8266 | no: GCC 10.3 |

Where an Arduino core compiles as C++17 or older, put `compiler.cpp.extra_flags=-std=gnu++20` into its `platform.local.txt`.

An instance takes 14.5 KB of RAM with 12 hypotheses and 7.4 KB with one; smaller definitions, flash and stack:
docs/reference/c-interface.md, memory and time.

## Zephyr

    manifest:                       # west.yml of the application
      projects:
        - name: zerorate
          url: ...                  # where you keep this folder
          revision: main
          path: modules/lib/zerorate

    # prj.conf
    CONFIG_CPP=y
    CONFIG_STD_CPP20=y
    CONFIG_ZERORATE=y
    CONFIG_ZERORATE_HYPOTHESES_4=y  # or _12, _1
    CONFIG_MAIN_STACK_SIZE=4096     # 1,024 is too small for the calls of the interface
    CONFIG_FPU=y                    # where there is one
"""

CMAKE = """# A folder for add_subdirectory(), giving zerorate::c, and a component of ESP-IDF.
cmake_minimum_required(VERSION 3.16)
set(options -ffp-contract=off -fno-math-errno -fno-fast-math -fno-exceptions -fno-rtti -fno-threadsafe-statics)
if(ESP_PLATFORM)
  idf_component_register(SRCS src/zerorate.cpp INCLUDE_DIRS src)
  target_compile_features(${COMPONENT_LIB} PRIVATE cxx_std_20)
  target_compile_options(${COMPONENT_LIB} PRIVATE ${options})
  return()
endif()
project(zerorate VERSION @version@ LANGUAGES CXX)
add_library(zerorate_objects STATIC src/zerorate.cpp)
set_target_properties(zerorate_objects PROPERTIES OUTPUT_NAME zerorate CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON)
target_compile_options(zerorate_objects PRIVATE ${options})
add_library(zerorate_c INTERFACE)
add_library(zerorate::c ALIAS zerorate_c)
add_dependencies(zerorate_c zerorate_objects)
target_link_libraries(zerorate_c INTERFACE "$<TARGET_FILE:zerorate_objects>")
target_include_directories(zerorate_c INTERFACE "${CMAKE_CURRENT_SOURCE_DIR}/src")
"""

# One error instead of hundreds, where a compiler cannot do it.
REFUSALS = """#if __cplusplus < 202002L
#error "zerorate is written in C++20, and needs GCC 11 or clang 13 or later, with -std=gnu++20: README.md, targets"
#elif !__has_include(<array>)
#error "zerorate needs the headers of a C++ library; those of AVR have none: README.md, targets"
#else
"""

ZEPHYR_MODULE = """name: zerorate
build:
  cmake: zephyr
  kconfig: zephyr/Kconfig
"""

ZEPHYR_KCONFIG = """# Not built in a Zephyr tree: README.md.
config ZERORATE
	bool "Bias prediction for MEMS gyroscopes (zerorate)"
	depends on STD_CPP20
	select REQUIRES_FULL_LIBCPP
	help
	  The C interface of zerorate: zerorate.h. Needs CONFIG_CPP and C++20; on a processor with a
	  floating-point unit, CONFIG_FPU.

if ZERORATE

choice ZERORATE_HYPOTHESES_CHOICE
	prompt "Noise models that an instance weighs"
	default ZERORATE_HYPOTHESES_12

config ZERORATE_HYPOTHESES_12
	bool "12: learns the noise of the sensor"

config ZERORATE_HYPOTHESES_4
	bool "4: learns it more coarsely"

config ZERORATE_HYPOTHESES_1
	bool "1: takes the model at its word"

endchoice

config ZERORATE_HYPOTHESES
	int
	default 12 if ZERORATE_HYPOTHESES_12
	default 4 if ZERORATE_HYPOTHESES_4
	default 1

comment "The thread that calls zerorate needs 3 KiB of stack: MAIN_STACK_SIZE is 1,024 by default"

endif
"""

ZEPHYR_CMAKE = """if(CONFIG_ZERORATE)
  zephyr_library_named(zerorate)
  zephyr_library_sources(${CMAKE_CURRENT_LIST_DIR}/../src/zerorate.cpp)
  zephyr_library_compile_options(-ffp-contract=off -fno-math-errno -fno-fast-math)
  zephyr_include_directories(${CMAKE_CURRENT_LIST_DIR}/../src)
  zephyr_compile_definitions(ZERORATE_HYPOTHESES=${CONFIG_ZERORATE_HYPOTHESES})
endif()
"""


def version():
    return re.search(r"project\(zerorate VERSION (\S+)", (REPOSITORY / "CMakeLists.txt").read_text())[1]


def expanded(name, seen):
    """The lines of a file with what it includes in place; a header of the repository or of the system only once."""
    for line in (REPOSITORY / name).read_text(encoding="utf-8").splitlines():
        include = INCLUDE.match(line)
        if line.strip() == "#pragma once":
            continue
        if include is None:
            yield line
        elif include[2] in seen:
            continue
        elif include[1] == "<":
            seen.add(include[2])
            yield line
        else:
            seen.add(include[2])
            folder, _, header = include[2].rpartition("/")
            if folder == INCLUDE_FOLDER:
                yield f'#include "{header}"'
            else:
                yield from expanded(include[2], seen)


def amalgam():
    seen = set()
    lines = [f"// zerorate {version()}, Apache-2.0: one file made of {{count}} by toolchains/package/amalgamate.py. C++20."]
    for name in SOURCES:
        lines += [*expanded(name, seen), ""]
    count = len(SOURCES) + sum((REPOSITORY / name).is_file() for name in seen)
    lines[1:1] = [REFUSALS]
    lines.append("#endif  // a compiler that can")
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(lines))
    return text.replace("{count}", str(count), 1)


def manifests():
    """Path below the output folder -> text."""
    platformio = {
        "name": "zerorate",
        "version": version(),
        "description": DESCRIPTION,
        "keywords": ["gyroscope", "imu", "bias", "kalman", "navigation"],
        "license": "Apache-2.0",
        "headers": "zerorate.h",
        "frameworks": ["espidf", "zephyr", "stm32cube", "cmsis"],
        "platforms": ["espressif32", "ststm32", "nordicnrf52", "native"],
        "build": {"srcDir": "src", "includeDir": "src", "unflags": "-std=gnu++11 -std=gnu++14 -std=gnu++17",
                  "flags": "-std=gnu++20 -ffp-contract=off -fno-math-errno"},
    }
    arduino = {
        "name": "zerorate",
        "version": version(),
        "author": "zerorate maintainers",
        "maintainer": "zerorate maintainers",
        "sentence": DESCRIPTION,
        "paragraph": "Needs a core with GCC 11 or later that compiles as C++20, such as that of the ESP32 from 3.0 on. Not for AVR and "
                     "the ESP8266.",
        "category": "Signal Input/Output",
        "url": "https://zerorate.invalid",
        "architectures": "esp32,rp2040,stm32",
        "includes": "zerorate.h",
    }
    component = (f'# Not built by ESP-IDF: README.md.\nversion: "{version()}"\ndescription: "{DESCRIPTION}"\n'
                 'license: "Apache-2.0"\ndependencies:\n  idf: ">=5.0"\n')
    return {
        "src/zerorate.cpp": amalgam(),
        **{f"src/{name}": (REPOSITORY / INCLUDE_FOLDER / name).read_text(encoding="utf-8") for name in HEADERS},
        **{f"examples/heading/{name}": (REPOSITORY / SKETCH / name).read_text(encoding="utf-8")
           for name in ("heading.ino", "mpu6050_model.h")},
        "README.md": README.replace("{version}", version()),
        "LICENSE": (REPOSITORY / "LICENSE").read_text(encoding="utf-8"),
        "CMakeLists.txt": CMAKE.replace("@version@", version()),
        "library.json": json.dumps(platformio, indent=2) + "\n",
        "library.properties": "".join(f"{key}={value}\n" for key, value in arduino.items()),
        "idf_component.yml": component,
        "zephyr/module.yml": ZEPHYR_MODULE,
        "zephyr/Kconfig": ZEPHYR_KCONFIG,
        "zephyr/CMakeLists.txt": ZEPHYR_CMAKE,
    }


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__)
        sys.exit(0 if sys.argv[1:] in (["--help"], ["-h"]) else 2)
    folder = pathlib.Path(sys.argv[1])
    for name, text in manifests().items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
