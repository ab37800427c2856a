#pragma once

namespace flatspeckle {

/// A quantity that is 0 in every exact result, such as the imbalance of energy. `off` is its
/// magnitude, and `limit` is the largest magnitude that the known errors of the run explain. If the
/// limit is exceeded, the result has not converged.
struct Invariant {
  double off = 0, limit = 0;

  bool holds() const { return off <= limit; }
  /// Whether off / limit is larger than for the other invariant.
  bool is_worse_than(const Invariant& other) const { return off * other.limit > other.off * limit; }
};

}  // namespace flatspeckle
