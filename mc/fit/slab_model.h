#pragma once

#include <vector>

#include <Eigen/Core>

#include "flatland/scene/scene.h"
#include "mc/fit/measurement.h"

namespace flatspeckle::mc {

/// Curves of slabs by transport, a smooth function of the medium: the number of ordinates does not
/// change between calls. Curves of one slab are solved together. Paths count walked backwards too
/// where a view is so near to exact backscattering that they make a thousandth.
class SlabModel {
 public:
  /// scenes: of each curve, of a medium like those that are to come. Throws InputError for boxes.
  SlabModel(std::vector<Curve> curves, const std::vector<Scene>& scenes);

  /// Of all curves, one after the other, in media of these scenes.
  Eigen::VectorXd values(const std::vector<Scene>& scenes) const { return solved(scenes, order_); }

  /// Takes more ordinates until still more change the values by less than `share` of these errors.
  /// Returns the largest change, in them.
  double refine(const std::vector<Scene>& scenes, const Eigen::VectorXd& errors, double share);

  int order() const { return order_; }
  bool reversed() const;

 private:
  /// Curves that one solution gives.
  struct Group {
    bool flux = false, reversed = false;
    std::vector<std::size_t> curves;
  };

  bool joins(const Group& group, const std::vector<Scene>& scenes, std::size_t curve) const;
  Eigen::VectorXd solved(const std::vector<Scene>& scenes, int order) const;
  void solve_fields(const Group& group, const std::vector<Scene>& scenes, int order,
                    Eigen::VectorXd& all) const;
  void solve_flux(const Group& group, const std::vector<Scene>& scenes, Eigen::VectorXd& all) const;

  std::vector<Curve> curves_;
  std::vector<Eigen::Index> first_;  ///< of each curve in all values
  Eigen::Index size_ = 0;
  std::vector<Group> groups_;
  int order_ = 5;  ///< nodes of a panel of directions
};

}  // namespace flatspeckle::mc
