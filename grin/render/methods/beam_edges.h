#pragma once

#include "grin/render/lights/light.h"
#include "grin/render/methods/moving_paths.h"

namespace flatspeckle::grin {

/// What unscattered light of beams moves over edges of pixels, per unit of each parameter of the
/// field. Such light is a sharp picture of its beam, and edges are taken as they are: light of a
/// beam starts at points of a square (u, v), by chance du dv (StageLights::beam_position), and
/// along a line of constant v it lands on an edge at some u, which moves by
///
///   du = - d(landing)/d(parameter) / (d(landing)/du),
///
/// both across the edge.
class BeamEdges {
 public:
  /// The line v of the beam that the stratum says.
  BeamEdges(const MovingField& field, const StageLights& lights, double stratum, double v)
      : field_(field), lights_(lights), stratum_(stratum), v_(v) {}

  /// Of so much power of all beams.
  void add(double power, Film& film, TransportCounts& counts) const;

 private:
  /// Light from a place of the line.
  struct Landed {
    double u;
    MovingField::Ray start;
    Flight flight;
  };
  using Line = std::vector<Landed>;
  /// Over an edge, between two places from where light lands on either side of it.
  struct Passage {
    const SensorEdges* edges;
    int edge;
    double low, high, below, above;  ///< places, and how far beyond the edge light lands
    Landed at;                       ///< the last between them
    bool is_found = false, was_low = false;

    void narrow(const Landed& place);
  };

  Line landed(std::span<const double> places) const;
  Line line() const;
  std::vector<Passage> passages() const;
  void find(std::vector<Passage>& all) const;
  std::vector<double> slopes(const std::vector<Passage>& all) const;
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
