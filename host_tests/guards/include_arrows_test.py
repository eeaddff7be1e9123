"""The include guard lets the tree pass and finds what is planted in one."""

import pathlib
import tempfile
import unittest

import include_arrows

REPOSITORY = pathlib.Path(__file__).parents[2]


def in_tree(files, look):
    """What `look` finds in a tree that holds just these {path: text}."""
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return look(root)


def findings_in(files):
    """The guard's findings with our table in a tree that holds just these {path: text}."""
    return in_tree(files, lambda root: include_arrows.findings(root, include_arrows.read_house()))


def house_of(rooms):
    return include_arrows.House({"rooms": rooms, "laboratory": {"rooms": ["host_tools/lab/*"]}, "flashed": {"rooms": [], "system_headers": []}})


class OurTree(unittest.TestCase):
    def setUp(self):
        self.house = include_arrows.read_house()

    def test_has_no_forbidden_arrow(self):
        self.assertEqual(include_arrows.findings(REPOSITORY, self.house), [])

    def test_has_a_table_that_names_every_room_by_itself(self):
        self.assertEqual(include_arrows.patterns(self.house), [])

    def test_has_a_table_whose_product_needs_no_laboratory(self):
        self.assertEqual(include_arrows.into_laboratory(self.house), [])

    def test_has_a_table_without_a_cycle(self):
        self.assertEqual(include_arrows.cycle(self.house), [])

    def test_uses_every_arrow_that_the_table_permits(self):
        self.assertEqual(include_arrows.unused(REPOSITORY, self.house), [])

    def test_has_a_line_for_every_folder_with_sources(self):
        self.assertEqual(include_arrows.unlisted(REPOSITORY, self.house), [])


class PlantedTable(unittest.TestCase):
    def test_with_a_pattern_in_a_library_is_found(self):
        house = house_of({"core/*": [], "host_tools/lib/a": ["core/*"], "host_tests": ["core/*"]})
        self.assertEqual(include_arrows.patterns(house), ["core/* -> core/* names more than one room",
                                                          "host_tools/lib/a -> core/* names more than one room"])

    def test_with_an_arrow_from_the_product_to_the_laboratory_is_found(self):
        house = house_of({"host_tools/lib/fleet": ["host_tools/lab/campaign"], "host_tools/lab/campaign": [],
                          "host_tools/lab/cli": ["host_tools/lab/campaign"], "host_tests": ["host_tools/lab/*"]})
        self.assertEqual(include_arrows.into_laboratory(house), [
            "host_tools/lib/fleet -> host_tools/lab/campaign makes the product need the laboratory"])

    def test_with_a_cycle_is_found(self):
        house = house_of({"core/a": ["core/b"], "core/b": ["core/c"], "core/c": ["core/a"]})
        self.assertEqual(len(include_arrows.cycle(house)), 1)
        self.assertTrue(include_arrows.cycle(house)[0].startswith("cycle: core/"))

    def test_with_an_arrow_that_nothing_uses_is_found(self):
        house = house_of({"core/a": ["core/b", "core/c"], "core/b": [], "core/c": [], "host_tests": ["core/*", "hal/*"]})
        tree = {"core/a/a.hpp": '#include "core/b/b.hpp"\n', "host_tests/a_test.cpp": '#include "core/b/b.hpp"\n'}
        self.assertEqual(in_tree(tree, lambda root: include_arrows.unused(root, house)),
                         ["core/a -> core/c is used by nothing", "host_tests -> hal/* is used by nothing"])

    def test_without_a_line_for_a_folder_or_with_one_too_many_is_found(self):
        house = house_of({"core/a": [], "core/b": [], "host_tests": []})
        tree = {"core/a/a.hpp": "", "core/a/inner/b.hpp": "", "host_tests/unit/a_test.cpp": ""}
        self.assertEqual(in_tree(tree, lambda root: include_arrows.unlisted(root, house)),
                         ["core/a/inner has no line", "core/b has no sources"])


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

    def test_upwards_inside_the_diagnosis_is_found(self):
        self.assert_refused("host_tools/lib/diagnose/hypothesis/a.hpp", '"host_tools/lib/diagnose/effects/a.hpp"',
                            "may not include host_tools/lib/diagnose/effects")
        self.assert_refused("host_tools/lib/diagnose/presentation/a.cpp", '"host_tools/lib/diagnose/diagnose.hpp"',
                            "may not include host_tools/lib/diagnose (")

    def test_from_a_tool_to_a_test_is_found(self):
        self.assert_refused("host_tools/cli/a.cpp", '"host_tests/support/a.hpp"', "may not include host_tests")

    def test_from_the_product_to_the_laboratory_is_found(self):
        self.assert_refused("host_tools/lib/fleet/a.cpp", '"host_tools/lab/campaign/a.hpp"',
                            "may not include host_tools/lab/campaign")

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
            "firmware/model/a.cpp": '#include <vector>\n#include "core/noise/modes.hpp"\n',
            "host_tests/unit/core/a_test.cpp": '#include <gtest/gtest.h>\n#include "hal/testing/a.hpp"\n',
        }), [])


if __name__ == "__main__":
    unittest.main()
