#pragma once

#include <span>
#include <vector>

#include "core/complex.h"
#include "flatland/placement.h"

namespace flatspeckle::wave {

/// The multiple-scattering equations of one placement (C10) in scaled unknowns: with tau_n =
/// sqrt(T_n) and b_n = tau_n beta_n,
///   (1 - tau S tau) beta = tau a,
/// whose entries are of moderate size however many orders T_n and S span (C11). Unknowns run over
/// scatterers and, within each, n = -order .. order.
class TMatrixSystem {
 public:
  /// Orders follow from the tolerance (basis_order.h). sensors: where the near field will be
  /// wanted. Throws InputError for scatterers without a T-matrix or disks too close to be resolved.
  TMatrixSystem(Placement placement, double k, double tolerance,
                std::span<const Vec2> sensors = {});

  const Placement& placement() const { return placement_; }
  double k() const { return k_; }
  std::size_t unknowns() const { return first_.back(); }
  int order(std::size_t scatterer) const { return order_[scatterer]; }
  /// First unknown of a scatterer, n = -order.
  std::size_t first(std::size_t scatterer) const { return first_[scatterer]; }
  /// tau_n for n = 0 .. order; tau_{-n} = tau_n.
  std::span<const ExtendedComplex> tau(std::size_t scatterer) const { return tau_[scatterer]; }

  /// 1 - tau S tau, column by column. Throws InputError if it cannot fit in this machine's memory.
  std::vector<Complex> matrix() const;
  /// (1 - tau S tau) x formed block by block, without the matrix. x: [column][unknown].
  std::vector<Complex> apply(std::span<const Complex> x) const;

  /// tau a of unit plane waves (C6): [light][unknown].
  std::vector<Complex> right_sides(std::span<const double> light_angles) const;
  /// What each unknown adds to the far-field amplitude at an angle (C6).
  std::vector<Complex> far_row(double view_angle) const;
  /// What each unknown adds to the scattered field at a point. Throws InputError for a point inside
  /// a disk or on a point scatterer.
  std::vector<Complex> near_row(Vec2 point) const;
  /// Outgoing waves tau_n H_n(k r) e^{i n phi} of one scatterer at a point, n = -order .. order,
  /// and their derivatives along the unit vector `along`, divided by k.
  struct Outgoing {
    std::vector<Complex> field, derivative;
  };
  Outgoing outgoing(std::size_t scatterer, Vec2 point, Vec2 along) const;

 private:
  struct Block;
  void pair_blocks(std::size_t j, std::size_t l, Block to_j, Block to_l) const;
  std::vector<Complex> point_matrix() const;
  void plane_wave(double angle, std::span<Complex> column) const;

  Placement placement_;
  double k_;
  std::vector<int> order_;
  std::vector<std::size_t> first_;
  std::vector<std::vector<ExtendedComplex>> tau_;
  bool points_only_ = true;
};

}  // namespace flatspeckle::wave
