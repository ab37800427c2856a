#include "grin/render/methods/beam_edges.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flatspeckle::grin {

namespace {

// number of intervals of a line, in each of which edges are searched for
constexpr std::size_t places = 64;

bool is_on(const SensorEdges& edges, const Flight& flight) {
  return flight.end == Flight::End::boundary && edges.is_on_face(flight.point.x);
}

/// Vertex of the parabola through three points (u, f).
struct Summit {
  double u, value;
};
Summit turn(const std::array<double, 3>& u, const std::array<double, 3>& f) {
  const double first = (f[1] - f[0]) / (u[1] - u[0]), second = (f[2] - f[1]) / (u[2] - u[1]);
  const double bend = (second - first) / (u[2] - u[0]);
  const double at = (u[0] + u[1]) / 2 - first / (2 * bend);
  return {at, f[0] + (at - u[0]) * (first + bend * (at - u[1]))};
}

}  // namespace

/// Traces light from the points of the line with these u.
BeamEdges::Line BeamEdges::landed(std::span<const double> at) const {
  std::vector<MovingField::Ray> starts;
  for (const double u : at) {
    const EndPosition from = lights_.beam_position(stratum_, u, v_);
    starts.push_back({from.point.x, from.inward});
  }
  const std::vector<Flight> flights = field_.flown(starts);
  Line line;
  for (std::size_t i = 0; i < at.size(); ++i) line.push_back({at[i], starts[i], flights[i]});
  return line;
}

/// Traces light from points along the line. Points are added where the landing point turns back
/// near an edge, which it may have crossed twice.
BeamEdges::Line BeamEdges::line() const {
  std::vector<double> at;
  for (std::size_t i = 0; i <= places; ++i) at.push_back(static_cast<double>(i) / places);
  Line line = landed(at);
  at.clear();
  for (std::size_t i = 0; i + 2 < line.size(); ++i)
    for_each_edge([&](const SensorEdges& edges, int edge) {
      std::array<double, 3> u, f;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!is_on(edges, line[i + k].flight)) return;
        u[k] = line[i + k].u;
        f[k] = edges.beyond(edge, line[i + k].flight.point.x);
      }
      if (!((f[1] - f[0]) * (f[2] - f[1]) < 0)) return;
      const Summit turns = turn(u, f);
      if (std::abs(turns.value) < std::abs(f[2] - f[1]) + std::abs(f[1] - f[0]))
        at.push_back(turns.u);
    });
  const Line turns = landed(at);
  line.insert(line.end(), turns.begin(), turns.end());
  std::ranges::sort(line, {}, &Landed::u);
  return line;
}

std::vector<BeamEdges::EdgeCrossing> BeamEdges::edge_crossings() const {
  const Line all = line();
  std::vector<EdgeCrossing> found;
  for (std::size_t i = 0; i + 1 < all.size(); ++i)
    for_each_edge([&](const SensorEdges& edges, int edge) {
      const Flight &one = all[i].flight, &other = all[i + 1].flight;
      if (!is_on(edges, one) || !is_on(edges, other)) return;
      const double below = edges.beyond(edge, one.point.x),
                   above = edges.beyond(edge, other.point.x);
      if (below * above < 0)
        found.push_back({&edges, edge, all[i].u, all[i + 1].u, below, above, {}});
    });
  find(found);
  return found;
}

/// Locates all edge crossings at the same time, by the Illinois secant method with a bisection
/// every fourth step.
void BeamEdges::find(std::vector<EdgeCrossing>& all) const {
  for (int step = 0; step < 24; ++step) {
    std::vector<double> at;
    for (const EdgeCrossing& one : all)
      at.push_back(step % 4 == 3
                       ? (one.low + one.high) / 2
                       : (one.low * one.above - one.high * one.below) / (one.above - one.below));
    const Line line = landed(at);
    for (std::size_t i = 0; i < all.size(); ++i) all[i].narrow(line[i]);
    if (std::ranges::all_of(all, &EdgeCrossing::is_found)) return;
  }
}

void BeamEdges::EdgeCrossing::narrow(const Landed& place) {
  const double beyond =
      is_on(*edges, place.flight) ? edges->beyond(edge, place.flight.point.x) : above;
  at = place;
  is_found = std::abs(beyond) < 1e-10 * std::abs(edges->edge_at(edge).size);
  const bool is_low = beyond * below > 0;
  (is_low ? low : high) = place.u;
  (is_low ? below : above) = beyond;
  (is_low ? above : below) /= was_low == is_low ? 2 : 1;
  was_low = is_low;
}

void BeamEdges::add(double power, Film& film, TransportCounts& counts) const {
  std::vector<EdgeCrossing> all = edge_crossings();
  std::erase_if(all, [](const EdgeCrossing& one) { return !one.is_found; });
  const std::vector<double> derivatives = this->derivatives(all);
  std::vector<MovingField::Ray> starts;
  MovingField::Lengths lengths;
  for (const EdgeCrossing& one : all) {
    starts.push_back(one.at.start);
    lengths.push_back(one.at.flight.arc_length);
  }
  const std::vector<MovingField::Motion> still(all.size());
  for (std::size_t parameter = 0; parameter < field_.parameters(); ++parameter) {
    const auto motions = field_.moved(parameter, starts, still, std::span(&lengths, 1)).front();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Flight& flight = all[i].at.flight;
      const Vec3 &x = flight.point.x, &motion = motions[i].x;
      const Vec3 landing =
          motion + field_.exit_distance(x, flight.direction).dot(motion) * flight.direction;
      const double over = all[i].edges->speed(all[i].edge, x, landing) / std::abs(derivatives[i]);
      all[i].edges->pass(all[i].edge, x, [&](int pixel, double share) {
        for (int width = 0; width < edge_widths; ++width)
          deposit_by_field(film, counts, pixel, static_cast<int>(parameter) * edge_widths + width,
                           power * flight.weight * over * share);
      });
    }
  }
}

/// Returns, for each crossing, the derivative by u of the distance by which light lands beyond the
/// edge.
std::vector<double> BeamEdges::derivatives(const std::vector<EdgeCrossing>& all) const {
  constexpr double apart = 1e-4;
  std::vector<double> at;
  for (const EdgeCrossing& one : all)
    for (const double by : {-apart, apart}) at.push_back(std::clamp(one.at.u + by, 0.0, 1.0));
  const Line line = landed(at);
  std::vector<double> found;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto beyond = [&](const Landed& place) {
      return all[i].edges->beyond(all[i].edge, place.flight.point.x);
    };
    const Landed &low = line[2 * i], &high = line[2 * i + 1];
    found.push_back((beyond(high) - beyond(low)) / (high.u - low.u));
  }
  return found;
}

}  // namespace flatspeckle::grin
