#include "grin/rays/connections/damped_step.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "grin/media/geometry/frame.h"

namespace flatspeckle::grin {

namespace {

constexpr double longest_turn = 0.7;  // largest turn of the start direction in one step, rad

double turn(const CurveChange& change) {
  return std::hypot(change.first_angle, change.second_angle);
}

Vec3 turned(const Vec3& direction, const Frame& across, const CurveChange& change, double part) {
  return (direction +
          part * (change.first_angle * across.col(0) + change.second_angle * across.col(1)))
      .normalized();
}

}  // namespace

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

Vec3 turned(const Vec3& direction, const CurveChange& change) {
  return turned(direction, frame_across(direction), change,
                std::min(1.0, longest_turn / turn(change)));
}

CurveStart stepped(const CurveStart& start, double n, const RayState& end,
                   const RayTangent& tangent, const Vec3& error, DampedStep& step) {
  const Frame across = frame_across(start.direction), moved = n * tangent.dx * across;
  const double speed = end.v.norm();
  const CurveChange change = step({moved.col(0), moved.col(1), end.v / speed}, error);
  const double longer = change.length / speed;
  const double part =
      std::min({1.0, longest_turn / turn(change), start.sigma / std::abs(longer) / 2});
  return {turned(start.direction, across, change, part), start.sigma + part * longer};
}

}  // namespace flatspeckle::grin
