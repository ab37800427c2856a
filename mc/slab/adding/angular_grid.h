#pragma once

#include <compare>
#include <vector>

#include "core/algebra/dense.h"
#include "core/numbers/complex.h"
#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

/// Where radiance changes within a small angle: near a light where scattering is forward-peaked, or
/// where the phase of a pair of lights stands still.
struct Focus {
  double angle, width;  ///< angle in the first quadrant
  auto operator<=>(const Focus&) const = default;
};

/// Ordinates of a quadrant, 0 < theta < pi/2, which stand for the other three by symmetry: panels
/// that grow away from the foci, and on each a polynomial of theta by its values at Gauss nodes; on
/// the last of sqrt(pi/2 - theta), for radiance has a logarithm at grazing angles near the faces.
class AngularGrid {
 public:
  /// order: nodes of a panel. fine: the angle within which a phase function may change; integrals
  /// against it are taken on subpanels as narrow.
  AngularGrid(const std::vector<Focus>& foci, int order, double fine);

  Eigen::Index size() const { return cosine_.size(); }
  const Eigen::VectorXd& angle() const { return angle_; }
  const Eigen::VectorXd& cosine() const { return cosine_; }
  const Eigen::VectorXd& weight() const { return weight_; }

  /// Integrals of l_j f over the quadrant, l_j the polynomial that is 1 at node j and 0 at the
  /// others of its panel.
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

  /// The same of many functions: f(angles) returns [angle][function].
  template <typename F>
  Matrix integrals_of(Eigen::Index functions, const F& f) const {
    Matrix found = Matrix::Zero(size(), functions);
    for (const Subpanel& part : subpanels_)
      found.middleRows(part.first, order_) += product(part.weighted_basis, f(part.angle));
    return found;
  }

  /// The same of the indicator of [from, to].
  Eigen::VectorXd interval_integrals(double from, double to) const;

 private:
  struct Panel {
    double from, to;
    Eigen::Index first;
  };
  struct Subpanel {
    Eigen::Index first;
    Eigen::VectorXd angle;
    Matrix weighted_basis;  ///< l_j at the angles, times their weights: [node][angle]
  };
  void add_panel(double from, double to, double fine);
  bool is_last(const Panel& panel) const;
  const QuadratureRule& nodes_of(const Panel& panel) const;

  int order_;
  QuadratureRule nodes_, last_nodes_;  ///< of a panel, of the last
  QuadratureRule inner_;               ///< of a subpanel
  QuadratureRule exact_;               ///< for polynomials of a panel
  Eigen::VectorXd angle_, cosine_, weight_;
  std::vector<Panel> panels_;
  std::vector<Subpanel> subpanels_;
};

}  // namespace flatspeckle::mc
