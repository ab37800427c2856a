#pragma once

#include "grin/render/lights/light.h"
#include "grin/render/methods/moving_paths.h"

namespace flatspeckle::grin {

/// Derivatives, by parameters of the field, due to unscattered light of beams that moves across
/// pixel edges. Such light forms a sharp image of its beam, so that edges must be treated exactly.
/// Light of a beam starts at points (u, v) of a unit square with density du dv
/// (StageLights::beam_position). Along a line of constant v, the light from some u lands on an
/// edge. When a parameter changes, this u moves by
///
///   du = - d(landing)/d(parameter) / (d(landing)/du),
///
/// per unit of the parameter, where d(landing) is the displacement of the landing point across the
/// edge.
class BeamEdges {
 public:
  /// Selects the line of constant v on the beam that belongs to the stratum.
  BeamEdges(const MovingField& field, const StageLights& lights, double stratum, double v)
      : field_(field), lights_(lights), stratum_(stratum), v_(v) {}

  /// Adds the derivatives to the film. power: power of all beams, which the line represents.
  void add(double power, Film& film, TransportCounts& counts) const;

 private:
  /// A ray from one point of the line, traced to the boundary.
  struct Landed {
    double u;
    MovingField::Ray start;
    Flight flight;
  };
  using Line = std::vector<Landed>;
  /// Place where the landing point of light crosses an edge of the sensor: light from two
  /// neighbouring points of a line across the beam lands on opposite sides of that edge.
  struct EdgeCrossing {
    const SensorEdges* edges;
    int edge;
    /// Positions u of the two points; distances by which their rays land beyond the edge.
    double low, high, below, above;
    Landed at;  ///< last ray traced from a point between the two
    bool is_found = false, was_low = false;

    void narrow(const Landed& place);
  };

  Line landed(std::span<const double> places) const;
  Line line() const;
  std::vector<EdgeCrossing> edge_crossings() const;
  void find(std::vector<EdgeCrossing>& all) const;
  std::vector<double> derivatives(const std::vector<EdgeCrossing>& all) const;
  template <class Use>
  void for_each_edge(const Use& use) const {
    for (const SensorEdges& edges : field_.edges())
      for (int edge = 0; edge < edges.edges(); ++edge)
        if (edges.edge_at(edge).size > 0) use(edges, edge);
  }

  const MovingField& field_;
  const StageLights& lights_;
  double stratum_, v_;
};

}  // namespace flatspeckle::grin
