// Drives in which the reference, the rows or the full scale are at fault: the fault is named, and
// nothing else.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "host_tests/evidence/drives/diagnosed_hour.hpp"
#include "host_tools/lab/campaign/drive_hour.hpp"
#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::diagnose {
namespace {

using simulate::ScenarioDrive;
using simulate::ScenarioRow;
using units::kRadPerDeg;

constexpr std::uint64_t kSeeds = 4;
constexpr std::size_t kRowsPerSecond = 25;

/// Rows from a departure to the next arrival.
struct Rows {
  std::size_t from = 0;
  std::size_t to = 0;
};

std::vector<Rows> drives_of(const ScenarioDrive& drive) {
  std::vector<Rows> drives;
  bool moved = false;
  for (std::size_t k = 0; k < drive.rows.size(); ++k) {
    const bool moves = drive.rows[k].row.ref_speed_m_s > 0.05F;
    if (moves && !moved) drives.push_back({k, k});
    if (moves) drives.back().to = k;
    moved = moves;
  }
  return drives;
}

/// The row in which a drive turns fastest.
std::size_t fastest(const ScenarioDrive& drive, const Rows& rows) {
  std::size_t best = rows.from;
  for (std::size_t k = rows.from; k < rows.to; ++k) {
    if (std::abs(drive.rows[k].true_rate_rad_s[2]) >
        std::abs(drive.rows[best].true_rate_rad_s[2])) {
      best = k;
    }
  }
  return best;
}

float wrapped(double rad) {
  return static_cast<float>(std::remainder(rad, 2.0 * 3.14159265358979));
}

/// The third, sixth and ninth drive.
std::vector<Rows> some_of(const ScenarioDrive& drive) {
  const std::vector<Rows> all = drives_of(drive);
  return {all.at(2), all.at(5), all.at(8)};
}

const Parameter& parameter_of(const Cause& cause, const std::string& name) {
  const auto found = std::ranges::find(cause.parameters, name, &Parameter::name);
  if (found == cause.parameters.end()) throw std::out_of_range(name);
  return *found;
}

/// Diagnosis of hours with a fault, of which the only cause is given to a check.
template <class Fault, class Check>
void expect_alone(const char* effect, const Fault& fault, const Check& check) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    ScenarioDrive drive = campaign::make_hour(seed, {}).drive;
    fault(drive);
    const DriveDiagnosis diagnosis = diagnosis_of(drive);
    ASSERT_EQ(diagnosis.causes.size(), 1) << effect << ", seed " << seed;
    EXPECT_EQ(diagnosis.causes[0].effect, effect) << "seed " << seed;
    check(diagnosis.causes[0]);
  }
}

void delay_reference(ScenarioDrive& drive, std::size_t rows) {
  for (std::size_t k = drive.rows.size(); k-- > rows;) {
    drive.rows[k].row.ref_heading_rad = drive.rows[k - rows].row.ref_heading_rad;
  }
}

TEST(FaultsInDrives, ALateReferenceIsNamedWithItsDelay) {
  for (const std::size_t rows : std::vector<std::size_t>{5, 25, 50}) {
    expect_alone(
        "reference_delay", [&](ScenarioDrive& drive) { delay_reference(drive, rows); },
        [&](const Cause& cause) {
          const double delay_s = static_cast<double>(rows) / kRowsPerSecond;
          EXPECT_NEAR(parameter_of(cause, "delay_s").value, delay_s, 0.025);
        });
  }
}

// In fast turns a late reference parts from the gyro as one that jumps does. Of the turns from stop
// to stop it lacks what comes later than the rest beside the way.
TEST(FaultsInDrives, ALateReferenceHidesNoScaleFactor) {
  for (const std::size_t rows : std::vector<std::size_t>{25, 65}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      ScenarioDrive drive =
          campaign::make_hour(seed, {.errors = {.scale_factor = {0.0, 0.0, 0.01}}}).drive;
      delay_reference(drive, rows);
      const DriveDiagnosis diagnosis = diagnosis_of(drive);
      ASSERT_EQ(diagnosis.causes.size(), 2) << rows << " rows, seed " << seed;
      EXPECT_EQ(diagnosis.causes[0].effect, "scale_factor") << "seed " << seed;
      EXPECT_EQ(diagnosis.causes[1].effect, "reference_delay") << "seed " << seed;
    }
  }
}

TEST(FaultsInDrives, AReferenceThatJumpsIsNamed) {
  expect_alone(
      "reference_fault",
      [](ScenarioDrive& drive) {
        for (const Rows& rows : some_of(drive)) {
          for (std::size_t k = (rows.from + rows.to) / 2; k < drive.rows.size(); ++k) {
            ScenarioRow& row = drive.rows[k];
            row.row.ref_heading_rad = wrapped(double{row.row.ref_heading_rad} + 4.0 * kRadPerDeg);
          }
        }
      },
      [](const Cause& cause) { EXPECT_EQ(parameter_of(cause, "jump_drives").value, 3.0); });
}

TEST(FaultsInDrives, AReferenceThatTurnsTheOtherWayIsNamed) {
  expect_alone(
      "reference_fault",
      [](ScenarioDrive& drive) {
        for (const Rows& rows : some_of(drive)) {
          const double before = drive.rows[rows.from].true_heading_rad;
          const double turned = drive.rows[rows.to].true_heading_rad - before;
          for (std::size_t k = rows.from; k < drive.rows.size(); ++k) {
            ScenarioRow& row = drive.rows[k];
            const double by = k <= rows.to ? 2.0 * (row.true_heading_rad - before) : 2.0 * turned;
            row.row.ref_heading_rad = wrapped(double{row.row.ref_heading_rad} - by);
          }
        }
      },
      [](const Cause& cause) { EXPECT_EQ(parameter_of(cause, "wrong_sign_drives").value, 3.0); });
}

TEST(FaultsInDrives, AReferenceThatStandsIsNamed) {
  expect_alone(
      "reference_fault",
      [](ScenarioDrive& drive) {
        for (const Rows& rows : some_of(drive)) {
          const std::size_t middle = fastest(drive, rows);
          const std::size_t from = middle - 2 * kRowsPerSecond;
          for (std::size_t k = from; k < middle + 2 * kRowsPerSecond; ++k) {
            drive.rows[k].row.ref_heading_rad = drive.rows[from].row.ref_heading_rad;
          }
        }
      },
      [](const Cause& cause) { EXPECT_EQ(parameter_of(cause, "frozen_drives").value, 3.0); });
}

TEST(FaultsInDrives, MissingRowsInTurnsAreNamed) {
  expect_alone(
      "gap_in_turn",
      [](ScenarioDrive& drive) {
        for (const Rows& rows : some_of(drive)) {
          const std::size_t middle = fastest(drive, rows);
          for (std::size_t k = middle; k < middle + kRowsPerSecond; ++k)
            drive.rows[k].row.time_ns = -1;
        }
        std::erase_if(drive.rows, [](const ScenarioRow& row) { return row.row.time_ns < 0; });
      },
      [](const Cause& cause) {
        EXPECT_EQ(parameter_of(cause, "drives_with_gap").value, 3.0);
        EXPECT_NEAR(parameter_of(cause, "missing_s").value, 3.0, 0.2);
      });
}

TEST(FaultsInDrives, AFullScaleInTurnsIsNamed) {
  expect_alone(
      "saturation_in_turn",
      [](ScenarioDrive& drive) {
        // Below the rate of U-turns.
        std::vector<double> rates;
        for (const Rows& rows : drives_of(drive)) {
          rates.push_back(std::abs(drive.rows[fastest(drive, rows)].true_rate_rad_s[2]));
        }
        std::ranges::sort(rates);
        const auto limit = static_cast<float>(rates.back() * 0.9);
        for (ScenarioRow& row : drive.rows) {
          for (float& rate : row.row.rate_rad_s) rate = std::clamp(rate, -limit, limit);
        }
      },
      [](const Cause& cause) {
        EXPECT_GT(parameter_of(cause, "saturated_drives").value, 0.0);
        EXPECT_GT(parameter_of(cause, "lost_turn_deg").value, 0.0);
      });
}

}  // namespace
}  // namespace zerorate::diagnose
