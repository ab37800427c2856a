#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "mc/fit/model/distance_curves.h"
#include "mc/fit/task/curve_values.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::mc {

/// Computes the measured curves of slabs by solving the transport of field pairs. The values are a
/// smooth function of the medium, because the resolution does not change between calls of
/// values(). Curves of the same slab with the same delays are solved together. Reversed paths are
/// included if needs_reversed() returns true.
class SlabModel {
 public:
  /// media: the medium of each curve, representative of the media in later calls. Throws InputError
  /// for boxes, and for scatterers that flow.
  SlabModel(std::vector<Curve> curves, const Media& media);

  /// Returns the values of all curves, concatenated. media: the medium of each curve.
  Eigen::VectorXd values(const Media& media) const { return solution(media, resolution_); }

  /// Increases the resolution until a further increase changes no value by more than
  /// `share` of its error. Returns the largest change by that further increase, in units of the
  /// errors. solved: called after each solution.
  double refine(const Media& media, const Eigen::VectorXd& errors, double share,
                const std::function<void()>& solved);

  /// Returns all numbers that refine() increases.
  std::vector<int> resolution() const;
  bool reversed() const;

 private:
  /// Curves whose values follow from the same solution.
  struct Group {
    bool flux = false, reversed = false;
    std::vector<double> delays{};
    std::vector<std::size_t> curves{};
    std::optional<DistanceCurves> distances{};
  };

  /// Returns a group for curves that are solved like this one.
  Group empty_group(const Media& media, std::size_t curve) const;
  bool can_share(const Group& group, const Media& media, std::size_t curve) const;
  Eigen::VectorXd solution(const Media& media, const Resolution& at) const;
  void solve_fields(const Group& group, const Media& media, const Resolution& at,
                    Eigen::VectorXd& all) const;
  void solve_flux(const Group& group, const Media& media, Eigen::VectorXd& all) const;

  std::vector<Curve> curves_;
  std::vector<Eigen::Index> first_;  ///< index of each curve's first value among all values
  Eigen::Index size_ = 0;
  std::vector<Group> groups_;
  Resolution resolution_{5, 2};
};

}  // namespace flatspeckle::mc
