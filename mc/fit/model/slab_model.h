#pragma once

#include <vector>

#include <Eigen/Core>

#include "mc/fit/task/curve_values.h"

namespace flatspeckle::mc {

/// Curves of slabs by transport, a smooth function of the medium: the number of ordinates does not
/// change between calls. Curves of one slab, and after the same delays, are solved together. Paths
/// count walked backwards too where a view is so near to exact backscattering that they make a
/// thousandth.
class SlabModel {
 public:
  /// media: of each curve, like those that are to come. Throws InputError for boxes,
  /// and for scatterers that flow.
  SlabModel(std::vector<Curve> curves, const Media& media);

  /// Of all curves, one after the other, in their media.
  Eigen::VectorXd values(const Media& media) const { return solved(media, order_); }

  /// Takes more ordinates until still more change the values by less than `share` of these errors.
  /// Returns the largest change, in them.
  double refine(const Media& media, const Eigen::VectorXd& errors, double share);

  int order() const { return order_; }
  bool reversed() const;

 private:
  /// Curves that one solution gives.
  struct Group {
    bool flux = false, reversed = false;
    std::vector<double> delays;
    std::vector<std::size_t> curves;
  };

  bool joins(const Group& group, const Media& media, std::size_t curve) const;
  Eigen::VectorXd solved(const Media& media, int order) const;
  void solve_fields(const Group& group, const Media& media, int order, Eigen::VectorXd& all) const;
  void solve_flux(const Group& group, const Media& media, Eigen::VectorXd& all) const;

  std::vector<Curve> curves_;
  std::vector<Eigen::Index> first_;  ///< of each curve in all values
  Eigen::Index size_ = 0;
  std::vector<Group> groups_;
  int order_ = 5;  ///< nodes of a panel of directions
};

}  // namespace flatspeckle::mc
