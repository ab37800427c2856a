#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "bench/scenes/meshes.h"
#include "bench/scenes/random_fields.h"
#include "bench/scenes/render_scenes.h"
#include "grin/render/flights/space.h"
#include "tests/grin/furnace.h"
#include "tests/grin/space_stages.h"

namespace flatspeckle::grin::tests::test_mesh_body {

namespace {

const Box stage_box{Vec3::Constant(-2), Vec3::Constant(2)};

/// Returns the length inside a mesh of the segment between two outside points, from its crossings
/// of each triangle (Moeller and Trumbore).
double length_inside(const TriangleMesh& mesh, const Vec3& from, const Vec3& to) {
  const Vec3 segment = to - from;
  double sum = 0;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3 a = mesh.corners[i], ab = mesh.corners[j] - a, ac = mesh.corners[k] - a;
    const Vec3 n = ab.cross(ac), to_a = a - from, turned = to_a.cross(segment);
    const double speed = segment.dot(n);
    const double u = turned.dot(ac) / speed, v = -turned.dot(ab) / speed;
    const double at = to_a.dot(n) / speed;
    if (u >= 0 && v >= 0 && u + v <= 1 && at > 0 && at < 1)
      sum += (speed > 0 ? at : -at) * segment.norm();
  }
  return sum;
}

}  // namespace

TEST_CASE("straight segments through a torus: attenuation agrees with its triangles") {
  const TriangleMesh mesh = torus_mesh();
  const Stage stage{stage_box, {}, {Body{smooth(mesh, 0.05), {.mu_a = 1}}}};
  const Space space(Homogeneous{0}, stage);
  CHECK(!space.connects_through());
  RandomStream random(1, 98, 0);
  ConnectionStatistics statistics;
  double sum = 0, difference = 0;
  int rough = 0, twice = 0;
  constexpr int segments = 800;
  for (int i = 0; i < segments; ++i) {
    const Vec3 p = 1.2 * random_direction(random), q = 0.3 * random_direction(random) - p;
    const double exact = length_inside(mesh, p, q);
    const auto connection = space.connect({p}, {q}, random, statistics);
    REQUIRE(connection);
    const double found = -std::log(connection->transmittance);
    sum += exact;
    difference += found - exact;
    rough += std::abs(found - exact) > 0.005;
    twice += exact > 0.55;
    RandomStream again(2, 98, i);
    const Flight flight = space.fly({p}, (q - p).normalized(), again);
    CHECK(flight.end == Flight::End::boundary);
    CHECK(flight.weight == doctest::Approx(connection->transmittance).epsilon(1e-9));
  }
  CHECK(std::abs(difference) < 1e-3 * sum);
  CHECK(rough < 0.03 * segments);  // segments that graze the torus
  CHECK(twice > 50);
}

TEST_CASE("clear ball of triangles: transmits all rays at any index") {
  for (const double index : {1.0001, 1.4, 0.7}) {
    CAPTURE(index);
    const Stage stage{stage_box, {}, {Body{smooth(ball_mesh(5), 0.2)}}};
    const Space space(Homogeneous{index - 1}, stage);
    RandomStream random(3, 98, 0);
    int lost = 0;
    const int flights = is_night ? 200000 : 60000;
    for (int i = 0; i < flights; ++i) {
      const double rho = std::sqrt(random.uniform()), phi = 2 * std::numbers::pi * random.uniform();
      const Vec3 x(rho * std::cos(phi), rho * std::sin(phi), -1.9);
      const Flight flight = space.fly({x}, Vec3::UnitZ(), random);
      lost += flight.end != Flight::End::boundary;
      CHECK(flight.point.part == around);
    }
    CHECK(lost <= 2);
  }
}

TEST_CASE("white furnace with a body of triangles: radiance is uniform, by every estimator") {
  const LevelSurface torus = smooth(torus_mesh(), 0.08);
  for (const ScatteringMedium& medium : {ScatteringMedium(), fog(1, 0, 0.85)})
    for (const double excess : {0.0, 0.4}) {
      CAPTURE(excess);
      const Stage stage{unit_box(), medium, {Body{torus, medium}}};
      const RenderScene scene = scene_in(Homogeneous{excess}, stage, environment(), whole_face());
      for (const RenderMethod method : unbiased_methods) {
        CHECK(check_furnace_face(scene, method, 5000) < 0.1);
        if (method != RenderMethod::light) CHECK(check_furnace_camera(scene, method, 4000) < 0.1);
      }
    }
}

/// Connections through its curved surface are many, and some are found by one trial in thousands.
/// If their weights were thousands of times the others', a single path would dominate the variance
/// of a part of the batches.
TEST_CASE("ring of triangles: no single path dominates the variance") {
  const RenderJob job = render_job(even_ring(), {RenderMethod::bidirectional}, 4);
  std::vector<Complex> sums(job.batches.size);
  const int shares = 8, batches = (is_night ? 6000 : 1200) / shares;
  double sum = 0;
  std::vector<double> squares(shares);
  for (int i = 0; i < shares * batches; ++i) {
    std::ranges::fill(sums, 0);
    job.batches.run(i, sums);
    for (const Complex& pixel : std::span(sums).first(job.pictures)) {
      sum += pixel.real() / (shares * batches) / static_cast<double>(job.pictures);
      squares[i % shares] += pixel.real() * pixel.real();
    }
  }
  CHECK(sum / job.batches.samples_per_batch == doctest::Approx(std::numbers::pi).epsilon(0.01));
  std::ranges::sort(squares);
  CHECK(squares.back() < 2 * squares[shares / 2]);
}

}  // namespace flatspeckle::grin::tests::test_mesh_body
