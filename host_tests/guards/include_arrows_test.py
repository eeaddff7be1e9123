"""The include guard lets the tree pass and finds what is planted in one."""

import pathlib
import tempfile
import unittest

import include_arrows

REPOSITORY = pathlib.Path(__file__).parents[2]


def findings_in(files):
    """The guard's findings in a tree that holds just these {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return include_arrows.findings(root, include_arrows.read_house())


class OurTree(unittest.TestCase):
    def test_has_no_forbidden_arrow(self):
        self.assertEqual(include_arrows.findings(REPOSITORY, include_arrows.read_house()), [])


class PlantedArrow(unittest.TestCase):
    def assert_refused(self, path, include, complaint):
        found = findings_in({path: f"// a comment\n#include {include}\n"})
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(f"{path}:2: "), found[0])
        self.assertIn(complaint, found[0])

    def test_from_core_to_hal_is_found(self):
        self.assert_refused("core/noise/a.hpp", '"hal/contract/spi.hpp"', "core/noise may not include hal/contract")

    def test_from_hal_to_drivers_is_found(self):
        self.assert_refused("hal/sim/a.cpp", '"drivers/common/a.hpp"', "may not include drivers/common")

    def test_from_a_driver_to_the_estimator_is_found(self):
        self.assert_refused("drivers/lsm6dso/a.hpp", '"core/estimator/a.hpp"', "may not include core/estimator")

    def test_from_one_driver_to_another_is_found(self):
        self.assert_refused("drivers/lsm6dso/a.hpp", '"drivers/bmi088/a.hpp"', "may not include drivers/bmi088")

    def test_from_the_app_to_a_chip_is_found(self):
        self.assert_refused("firmware/app/a.hpp", '"drivers/lsm6dso/a.hpp"', "may not include drivers/lsm6dso")

    def test_from_firmware_to_test_doubles_and_host_tools_is_found(self):
        self.assert_refused("firmware/app/a.hpp", '"hal/testing/a.hpp"', "may not include hal/testing")
        self.assert_refused("firmware/boards/check/a.cpp", '"hal/testing/a.hpp"', "may not include hal/testing")
        self.assert_refused("firmware/model/a.hpp", '"host_tools/lib/report/a.hpp"', "may not include host_tools")

    def test_from_a_tool_to_a_test_is_found(self):
        self.assert_refused("host_tools/cli/a.cpp", '"host_tests/support/a.hpp"', "may not include host_tests")

    def test_relative_to_the_file_is_found(self):
        self.assert_refused("core/base/a.hpp", '"b.hpp"', "includes start at the root")

    def test_in_a_folder_without_a_room_is_found(self):
        self.assert_refused("core/magic/a.hpp", '"core/base/result.hpp"', "stands in no room")

    def test_heap_and_operating_system_in_flashed_code_are_found(self):
        for header in ("vector", "string", "iostream", "memory", "thread", "map", "functional", "cstdlib", "unistd.h"):
            self.assert_refused("core/base/a.hpp", f"<{header}>", f"is flashed and may not include <{header}>")
            self.assert_refused("firmware/app/a.hpp", f"<{header}>", f"is flashed and may not include <{header}>")


class AllowedInclude(unittest.TestCase):
    def test_is_not_complained_about(self):
        self.assertEqual(findings_in({
            "core/estimator/a.hpp": '#include <span>\n#include "core/noise/b.hpp"\n#include "core/estimator/c.hpp"\n',
            "firmware/model/a.cpp": '#include <vector>\n#include "firmware/app/gyro_node.hpp"\n',
            "host_tests/unit/core/a_test.cpp": '#include <gtest/gtest.h>\n#include "hal/testing/a.hpp"\n',
        }), [])


if __name__ == "__main__":
    unittest.main()
