#pragma once

#include <compare>
#include <vector>

#include "core/algebra/dense.h"
#include "core/numbers/complex.h"
#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

/// A direction near which radiance varies rapidly, so that the angular grid must be finer there. It
/// is the direction of an illumination if scattering is forward-peaked, or a direction in which the
/// phase of the radiance of a field pair is stationary.
struct Focus {
  /// Angle from z, in [0, pi/2], and the width of the range of angles in which radiance varies.
  double angle, width;
  auto operator<=>(const Focus&) const = default;
};

/// Discrete ordinates of the quadrant 0 < theta < pi/2, where theta is the angle from the normal z
/// of the slab. The other three quadrants follow by symmetry. The quadrant is divided into panels
/// whose widths grow with the distance from the foci, the angles near which radiance varies fast
/// (directions of lights and views, narrow peaks). On each panel radiance is a polynomial of
/// theta, given by its values at Gauss nodes. On the last panel it is a polynomial of sqrt(pi/2 -
/// theta), because radiance has a logarithmic singularity at grazing angles near the faces.
class AngularGrid {
 public:
  /// order: nodes per panel. fine: smallest angle over which a phase function varies. Panels are
  /// divided into subpanels of this width for integrals that contain a phase function.
  AngularGrid(const std::vector<Focus>& foci, int order, double fine);

  Eigen::Index size() const { return cosine_.size(); }
  const Eigen::VectorXd& angle() const { return angle_; }
  const Eigen::VectorXd& cosine() const { return cosine_; }
  const Eigen::VectorXd& weight() const { return weight_; }

  /// Returns the integral of l_j f over the quadrant for each node j. The polynomial l_j is 1 at
  /// node j and 0 at the other nodes of the same panel.
  template <typename F>
  Eigen::VectorXcd integrals(const F& f) const {
    Eigen::VectorXcd found = Eigen::VectorXcd::Zero(size());
    for (const Subpanel& part : subpanels_) {
      Eigen::VectorXcd values(part.angle.size());
      for (Eigen::Index i = 0; i < values.size(); ++i) values[i] = f(part.angle[i]);
      found.segment(part.first, order_) += part.weighted_basis * values;
    }
    return found;
  }

  /// Returns the integrals of l_j f for several functions f at once, [node][function]. f(angles)
  /// returns the values of all functions, [angle][function].
  template <typename F>
  Matrix integrals_of(Eigen::Index functions, const F& f) const {
    Matrix found = Matrix::Zero(size(), functions);
    for (const Subpanel& part : subpanels_)
      found.middleRows(part.first, order_) += product(part.weighted_basis, f(part.angle));
    return found;
  }

  /// Returns the integral of l_j, defined at integrals(), over [from, to] for each node j.
  Eigen::VectorXd interval_integrals(double from, double to) const;

 private:
  struct Panel {
    double from, to;
    Eigen::Index first;
  };
  struct Subpanel {
    Eigen::Index first;
    Eigen::VectorXd angle;
    /// Values of l_j at the angles, times the quadrature weights of the angles, [node][angle].
    Matrix weighted_basis;
  };
  void add_panel(double from, double to, double fine);
  bool is_last(const Panel& panel) const;
  const QuadratureRule& nodes_of(const Panel& panel) const;

  int order_;
  QuadratureRule nodes_, last_nodes_;  ///< nodes of other panels; nodes of the last panel
  QuadratureRule inner_;               ///< quadrature rule on a subpanel
  QuadratureRule exact_;  ///< quadrature rule that is exact for the polynomials of a panel
  Eigen::VectorXd angle_, cosine_, weight_;
  std::vector<Panel> panels_;
  std::vector<Subpanel> subpanels_;
};

}  // namespace flatspeckle::mc
