/// @file
/// Streets as legs of a vehicle: corners, roundabouts, U-turns and grades; and a driver who meets
/// all of them between stops.
#pragma once

#include <vector>

#include "host_tools/lib/random/random_stream.hpp"
#include "host_tools/lib/simulate/vehicle.hpp"

namespace zerorate::simulate {

/// Legs of a route, one manoeuvre after another. Angles are positive to the left. A turn begins
/// and ends with the rate of turn changing within a second, and turns by its angle in all.
class Route {
 public:
  /// Time at rest, once the vehicle has braked. Throws std::invalid_argument for a time below 0.
  void stand(double length_s);
  /// Straight on at a speed, after the change to it.
  /// @param grade rise of the road per distance
  void straight(double length_s, double speed_m_s, double grade = 0.0);
  /// A turn along a circle; at least two seconds long. Throws std::invalid_argument for an angle
  /// of 0, and for a radius or a speed that is not above 0.
  void turn(double angle_deg, double radius_m, double speed_m_s, double grade = 0.0,
            double bank = 0.0);
  /// 90 deg at a junction.
  /// @param side 1: left, -1: right
  void corner(double side);
  /// Away from its middle, around it, and away from it again.
  /// @param net_deg change of the heading, from -90 (the first exit) to 180 (the way back), where
  /// traffic keeps to the right
  void roundabout(double net_deg);
  /// 180 deg to the left within the width of a street.
  void u_turn();

  [[nodiscard]] const std::vector<Leg>& legs() const { return legs_; }
  [[nodiscard]] double length_s() const { return length_s_; }

 private:
  void add(const Leg& leg);

  std::vector<Leg> legs_;
  double length_s_ = 0.0;
};

/// Habits of a driver in streets: lengths are exponential around their means.
struct StreetParams {
  double duration_s = 1800.0;
  double shortest_stop_s = 6.0;
  double mean_stop_s = 20.0;
  double manoeuvres_per_drive = 3.0;  ///< mean number of corners, roundabouts and U-turns
  double mean_straight_s = 6.0;       ///< before each of them
  double speed_m_s = 10.0;            ///< on straights; each one's own lies within 40 % of it
  double u_turn_share = 0.1;          ///< share of the manoeuvres
  double roundabout_share = 0.25;     ///< share of the manoeuvres; the others are corners
  double graded_share = 0.4;          ///< share of the straights that have a grade
  double least_grade = 0.03;          ///< up or down, uniform between these
  double most_grade = 0.10;
};

/// Legs of a drive that begins with a stop of half a minute and ends at rest.
[[nodiscard]] std::vector<Leg> drive_in_streets(const StreetParams& params,
                                                const random::RandomStream& stream);

}  // namespace zerorate::simulate
