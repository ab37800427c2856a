#pragma once

namespace flatspeckle {

/// A quantity that is 0 in every right result, such as the imbalance of energy: its size, and how
/// large errors known to the run allow it to be. A result whose invariant fails has not converged.
struct Invariant {
  double off = 0, limit = 0;

  bool holds() const { return off <= limit; }
  /// Whether this one exceeds its limit by a larger factor.
  bool is_worse_than(const Invariant& other) const { return off * other.limit > other.off * limit; }
};

}  // namespace flatspeckle
