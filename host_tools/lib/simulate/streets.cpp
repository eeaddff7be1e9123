#include "host_tools/lib/simulate/streets.hpp"

#include <algorithm>
#include <cmath>

#include "host_tools/lib/simulate/draws.hpp"
#include "host_tools/lib/simulate/require.hpp"
#include "host_tools/lib/units/units.hpp"

namespace zerorate::simulate {
namespace {

constexpr double kAcceleration_m_s2 = 1.5;
constexpr double kTurnRamp_s = 1.0;
constexpr double kSlopeRamp_s = 2.0;
constexpr double kDepartsAfter_s = 30.0;

}  // namespace

void Route::add(const Leg& leg) {
  legs_.push_back(leg);
  length_s_ += leg.length_s;
}

void Route::stand(double length_s) {
  require(length_s >= 0.0, "length_s: expected a time from 0 on");
  straight(length_s, 0.0, legs_.empty() ? 0.0 : legs_.back().grade);
}

void Route::straight(double length_s, double speed_m_s, double grade) {
  const Leg before = legs_.empty() ? Leg{} : legs_.back();
  // Out of a turn first: the change of the rate of turn has a length of its own.
  if (before.turn_dps != 0.0) {
    add({.length_s = kTurnRamp_s,
         .speed_m_s = before.speed_m_s,
         .ramp_s = kTurnRamp_s,
         .grade = before.grade});
  }
  const double change_s = std::abs(speed_m_s - before.speed_m_s) / kAcceleration_m_s2;
  const double ramp_s = std::max(change_s, grade != before.grade ? kSlopeRamp_s : 0.2);
  add({.length_s = ramp_s + length_s, .speed_m_s = speed_m_s, .ramp_s = ramp_s, .grade = grade});
}

void Route::turn(double angle_deg, double radius_m, double speed_m_s, double grade, double bank) {
  require(radius_m > 0.0 && speed_m_s > 0.0, "radius_m and speed_m_s: expected both above 0");
  require(angle_deg != 0.0, "angle_deg: expected a turn");
  const Leg before = legs_.empty() ? Leg{} : legs_.back();
  if (before.speed_m_s != speed_m_s || before.turn_dps != 0.0) straight(0.0, speed_m_s, grade);
  const double fastest_dps = speed_m_s / radius_m * units::kDegPerRad;
  // A leg turns by its rate times its length, the change at its end by the next one included.
  const double length_s = std::max(std::abs(angle_deg) / fastest_dps, 2.0 * kTurnRamp_s);
  add({.length_s = length_s,
       .speed_m_s = speed_m_s,
       .turn_dps = angle_deg / length_s,
       .ramp_s = kTurnRamp_s,
       .grade = grade,
       .bank = bank});
}

void Route::corner(double side) {
  turn(90.0 * side, 8.0, 4.0);
}

void Route::roundabout(double net_deg) {
  constexpr double kAway_deg = 60.0;
  turn(-kAway_deg, 15.0, 6.0);
  turn(net_deg + 2.0 * kAway_deg, 12.0, 6.0);
  turn(-kAway_deg, 15.0, 6.0);
}

void Route::u_turn() {
  turn(180.0, 6.0, 3.0);
}

namespace {

class StreetDriver {
 public:
  StreetDriver(const StreetParams& params, const random::RandomStream& stream)
      : params_(params), draws_(stream.substream("streets")) {}

  std::vector<Leg> drive() {
    route_.stand(kDepartsAfter_s);
    while (route_.length_s() < params_.duration_s) {
      const double most = 2.0 * params_.manoeuvres_per_drive;
      const auto manoeuvres = static_cast<int>(std::lround(draws_.uniform(1.0, most - 1.0)));
      for (int k = 0; k < manoeuvres; ++k) {
        straight();
        manoeuvre();
      }
      straight();
      route_.stand(params_.shortest_stop_s +
                   draws_.exponential(params_.mean_stop_s - params_.shortest_stop_s));
    }
    return route_.legs();
  }

 private:
  void straight() {
    const double length_s = 2.0 + draws_.exponential(params_.mean_straight_s);
    const double speed_m_s = params_.speed_m_s * draws_.uniform(0.6, 1.4);
    const double sense = draws_.happens(0.5) ? 1.0 : -1.0;
    const double steep = draws_.uniform(params_.least_grade, params_.most_grade);
    const double grade = draws_.happens(params_.graded_share) ? sense * steep : 0.0;
    route_.straight(length_s, speed_m_s, grade);
  }

  void manoeuvre() {
    const double kind = draws_.uniform(0.0, 1.0);
    if (kind < params_.u_turn_share) {
      route_.u_turn();
    } else if (kind < params_.u_turn_share + params_.roundabout_share) {
      constexpr double kExits = 4.0;
      route_.roundabout(90.0 * std::floor(draws_.uniform(0.0, kExits)) - 90.0);
    } else {
      route_.corner(draws_.happens(0.5) ? 1.0 : -1.0);
    }
  }

  StreetParams params_;
  Draws draws_;
  Route route_;
};

}  // namespace

std::vector<Leg> drive_in_streets(const StreetParams& params, const random::RandomStream& stream) {
  return StreetDriver{params, stream}.drive();
}

}  // namespace zerorate::simulate
