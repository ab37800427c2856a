#pragma once

#include <utility>

#include "grin/media/index/lanes.h"

namespace flatspeckle::grin {

/// Value of a radial profile n - 1 as a function of u = r^2, where r is the distance from a centre
/// or an axis, and its first and second derivatives with respect to u. The index is smooth at r = 0
/// if these derivatives are.
struct RadialJet {
  double excess, first, second;
};

/// The excess n - 1, and the derivative of n^2 with respect to u for profiles where this derivative
/// is constant.
struct RadialSquare {
  double excess, derivative;
};

/// A profile whose function jet() has no branches, so that a loop over SIMD lanes can be
/// vectorised.
template <class Profile>
concept LaneProfile = Profile::goes_in_lanes;

/// n = 1 + profile(r^2), where r is the distance from a centre (Dimension 3) or from the line
/// through the centre along z (Dimension 2). Profile must have excess(u) and jet(u), and may have
/// square(u).
template <class Profile, int Dimension>
class RadialField {
  static_assert(Dimension == 2 || Dimension == 3);

 public:
  explicit RadialField(Profile profile, const Vec3& centre = Vec3::Zero())
      : profile_(std::move(profile)), centre_(centre) {}

  const Profile& profile() const { return profile_; }
  const Vec3& centre() const { return centre_; }

  double excess(const Vec3& x) const { return profile_.excess(radius_vector(x).squaredNorm()); }
  IndexGradient gradient(const Vec3& x) const {
    const Vec3 r = radius_vector(x);
    const RadialJet jet = profile_.jet(r.squaredNorm());
    return {jet.excess, 2 * jet.first * r};
  }
  void gradients(const LaneVectors& x, LaneGradients& found) const requires LaneProfile<Profile> {
    const Profile profile = profile_;
    const double cx = centre_[0], cy = centre_[1], cz = centre_[2];
#pragma omp simd
    for (int k = 0; k < lanes; ++k) {
      const double rx = x.x[k] - cx, ry = x.y[k] - cy, rz = Dimension == 3 ? x.z[k] - cz : 0;
      const RadialJet jet = profile.jet(rx * rx + ry * ry + rz * rz);
      found.excess[k] = jet.excess;
      found.gradient.x[k] = 2 * jet.first * rx;
      found.gradient.y[k] = 2 * jet.first * ry;
      found.gradient.z[k] = 2 * jet.first * rz;
    }
  }
  IndexHessian hessian(const Vec3& x) const {
    const Vec3 r = radius_vector(x);
    const RadialJet jet = profile_.jet(r.squaredNorm());
    Mat3 hessian = 4 * jet.second * r * r.transpose();
    for (int i = 0; i < Dimension; ++i) hessian(i, i) += 2 * jet.first;
    return {jet.excess, 2 * jet.first * r, hessian};
  }
  DiagonalForce force(const Vec3& x) const requires requires(const Profile& profile) {
    profile.square(0.0);
  }
  {
    const Vec3 r = radius_vector(x);
    const auto [excess, derivative] = profile_.square(r.squaredNorm());
    return {excess, derivative * r, {derivative, derivative, Dimension == 3 ? derivative : 0}};
  }

 private:
  Vec3 radius_vector(const Vec3& x) const {
    if constexpr (Dimension == 3) return x - centre_;
    return {x[0] - centre_[0], x[1] - centre_[1], 0};
  }

  Profile profile_;
  Vec3 centre_;
};

}  // namespace flatspeckle::grin
