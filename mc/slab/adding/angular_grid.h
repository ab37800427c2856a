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

/// Refractive indices for an angular grid in one medium of a stack of layers. Light with the same
/// transverse momentum in two media has the same ordinate in their grids.
struct GridIndices {
  double own = 1;      ///< index of the medium of the grid
  double largest = 1;  ///< largest index of a layer; foci are angles in a medium of this index
  /// A smaller index. Radiance has a kink at the critical angle, where light becomes parallel to
  /// the faces in the medium of this index (C48).
  struct Smaller {
    double index;
    bool of_layer;  ///< whether a layer has this index, or only the medium outside
  };
  std::vector<Smaller> smaller{};  ///< in increasing order
};

/// Discrete ordinates of the quadrant 0 < theta < pi/2, where theta is the angle from the normal z
/// of the slab. The other three quadrants follow by symmetry. The quadrant is divided into panels
/// whose widths grow with the distance from the foci, the angles near which radiance varies fast
/// (directions of lights and views, narrow peaks). On each panel radiance is a polynomial of
/// theta, given by its values at Gauss nodes. On the last panel it is a polynomial of sqrt(pi/2 -
/// theta), because radiance has a logarithmic singularity at grazing angles near the faces. On a
/// panel that ends at a critical angle, theta is the angle in the medium where light becomes
/// parallel to the faces (C48).
class AngularGrid {
 public:
  /// order: nodes per panel; 0.6 times as many on the last panel if there are critical angles.
  /// fine: smallest angle over which a phase function varies. Panels are divided into subpanels of
  /// this width for integrals that contain a phase function.
  AngularGrid(const std::vector<Focus>& foci, int order, double fine,
              const GridIndices& indices = {});

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
      found.segment(part.first, part.weighted_basis.rows()) += part.weighted_basis * values;
    }
    return found;
  }

  /// Returns the integrals of l_j f for several functions f at once, [node][function]. f(angles)
  /// returns the values of all functions, [angle][function].
  template <typename F>
  Matrix integrals_of(Eigen::Index functions, const F& f) const {
    Matrix found = Matrix::Zero(size(), functions);
    for (const Subpanel& part : subpanels_)
      found.middleRows(part.first, part.weighted_basis.rows()) +=
          product(part.weighted_basis, f(part.angle));
    return found;
  }

  /// Returns the integral of l_j, defined at integrals(), over [from, to] for each node j.
  Eigen::VectorXd interval_integrals(double from, double to) const;

 private:
  /// A panel between two angles in a medium of index `base`, whose points are from + u width, or to
  /// - u^2 width if `root`.
  struct Panel {
    double base, from, to;
    bool root;
    Eigen::Index first;
    QuadratureRule rule;  ///< nodes, as points u

    double angle(double u) const {
      return root ? to - u * u * (to - from) : from + u * (to - from);
    }
    double derivative(double u) const { return (root ? 2 * u : 1) * (to - from); }
  };
  struct Subpanel {
    Eigen::Index first;
    Eigen::VectorXd angle;
    /// Values of l_j at the angles, times the quadrature weights of the angles, [node][angle].
    Matrix weighted_basis;
  };
  void add_panel(const Panel& panel, double fine);
  /// Returns the angle in the medium of the grid at the point u of [0, 1] of a panel.
  double at(const Panel& panel, double u) const;
  double cosine_at(const Panel& panel, double u) const;
  /// Returns the modulus of the derivative of that angle with respect to u.
  double derivative(const Panel& panel, double u) const;
  /// Returns the point u of a panel at an angle in the medium of the grid, or the nearest end.
  double point_at(const Panel& panel, double angle) const;

  double own_;            ///< refractive index of the medium of the grid
  QuadratureRule inner_;  ///< quadrature rule on a subpanel
  QuadratureRule exact_;  ///< quadrature rule that is exact for the polynomials of a panel
  Eigen::VectorXd angle_, cosine_, weight_;
  std::vector<Panel> panels_;
  std::vector<Subpanel> subpanels_;
};

}  // namespace flatspeckle::mc
