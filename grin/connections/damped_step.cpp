#include "grin/connections/damped_step.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace flatspeckle::grin {

CurveChange DampedStep::operator()(const EndJacobian& jacobian, const Vec3& error) {
  width_ = std::max({width_, jacobian.first_angle.norm(), jacobian.second_angle.norm()});
  Mat3 scaled;
  scaled << jacobian.first_angle / width_, jacobian.second_angle / width_, jacobian.along;
  const Vec3 e = error / width_;
  const double damping = std::max(factor_ * e.squaredNorm(), 1e-30);
  const Mat3 normal = scaled.transpose() * scaled + damping * Mat3::Identity();
  const Vec3 change = normal.ldlt().solve(-scaled.transpose() * e);
  return {change(0), change(1), width_ * change(2)};
}

void DampedStep::succeeded(double error_ratio) {
  if (error_ratio < 0.5) factor_ = std::max(factor_ / 4, 1e-3);
  if (error_ratio > 0.9) factor_ *= 2;
}

}  // namespace flatspeckle::grin
