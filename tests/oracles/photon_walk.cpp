#include "tests/oracles/photon_walk.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace flatspeckle::oracles {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double two_pi = 2 * std::numbers::pi;

double uniform(Random& random) {
  return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53;
}

Vec3 any_direction(Random& random) {
  const double z = 2 * uniform(random) - 1, angle = two_pi * uniform(random);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec3 any_normal_to(const Vec3& d) {
  return d.cross(std::abs(d.x()) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)).normalized();
}

double scattering_cosine(const WalkMedium& medium, Random& random) {
  const double u = uniform(random);
  switch (medium.law) {
    case WalkMedium::Law::isotropic:
      return 2 * u - 1;
    case WalkMedium::Law::henyey_greenstein: {
      const double g = medium.g;
      if (std::abs(g) < 1e-6) return 2 * u - 1;
      const double t = (1 - g * g) / (1 - g + 2 * g * u);
      return (1 + g * g - t * t) / (2 * g);
    }
    case WalkMedium::Law::rayleigh:  // density 3/8 (1 + c^2) of the cosine, by rejection
      for (;;) {
        const double c = 2 * uniform(random) - 1;
        if (2 * uniform(random) < 1 + c * c) return c;
      }
  }
  return 0;
}

Vec3 scattered(const Vec3& d, const WalkMedium& medium, Random& random) {
  const double cosine = scattering_cosine(medium, random);
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double angle = two_pi * uniform(random);
  const Vec3 u = any_normal_to(d), v = d.cross(u);
  return (cosine * d + sine * (std::cos(angle) * u + std::sin(angle) * v)).normalized();
}

/// Returns the roots s of |x + s d - c|^2 = r^2, or nullopt if they are not real.
std::optional<std::pair<double, double>> sphere_roots(const Vec3& x, const Vec3& d, const Vec3& c,
                                                      double r) {
  const double b = d.dot(x - c), q = b * b - (x - c).squaredNorm() + r * r;
  if (q <= 0) return {};
  return std::pair(-b - std::sqrt(q), -b + std::sqrt(q));
}

double exit_distance(const WalkShape& shape, const Vec3& x, const Vec3& d) {
  if (shape.radius > 0) {
    const auto roots = sphere_roots(x, d, shape.low, shape.radius);
    return roots ? std::max(0.0, roots->second) : 0;
  }
  double least = infinity;
  for (int i = 0; i < 3; ++i) {
    if (d[i] > 0) least = std::min(least, (shape.high[i] - x[i]) / d[i]);
    if (d[i] < 0) least = std::min(least, (shape.low[i] - x[i]) / d[i]);
  }
  return std::max(0.0, least);
}

bool is_out(const WalkShape& shape, const Vec3& x) {
  if (shape.radius > 0) return (x - shape.low).norm() > shape.radius;
  return (x - shape.low).minCoeff() < 0 || (shape.high - x).minCoeff() < 0;
}

/// Surface that a photon meets: the index of a ball, or one of the constants below.
using Met = int;
constexpr Met nothing = -1, boundary = -2;

/// Traces photons one by one.
class Walk {
 public:
  Walk(const WalkScene& scene, Random& random) : scene_(scene), random_(random) {}

  /// Traces a photon; returns whether it left the scene, false if it was absorbed.
  bool run(Photon& photon) {
    for (;;) {
      const WalkMedium& medium = medium_of(photon);
      const double mu = (medium.mu_s + medium.mu_a) * medium.largest_density;
      const double flight = mu > 0 ? -std::log(uniform(random_)) / mu : infinity;
      const Met met = is_curved(photon) ? go_curved(photon, flight) : go_straight(photon, flight);
      if (met == boundary) return true;
      if (met != nothing) {
        cross(photon, met);
      } else if (!collide(photon, medium)) {
        return false;
      }
    }
  }

 private:
  const WalkMedium& medium_of(const Photon& p) const {
    return p.ball >= 0 ? scene_.balls[p.ball].medium : scene_.medium;
  }
  bool is_curved(const Photon& p) const {
    return scene_.curved && p.ball == (scene_.balls.empty() ? -1 : 0);
  }
  double index(const Photon& p) const {
    if (is_curved(p)) return scene_.curved->n(p.x);
    return p.ball >= 0 ? scene_.balls[p.ball].index : scene_.around;
  }

  bool collide(Photon& photon, const WalkMedium& medium) {
    if (medium.density && uniform(random_) * medium.largest_density > medium.density(photon.x))
      return true;  // null collision
    if (uniform(random_) * (medium.mu_s + medium.mu_a) > medium.mu_s) return false;
    photon.direction = scattered(photon.direction, medium, random_);
    ++photon.scatterings;
    return true;
  }

  int balls() const { return static_cast<int>(scene_.balls.size()); }
  double length_to(int ball, const Photon& p) const {
    const auto& [centre, radius, medium, n] = scene_.balls[ball];
    const auto roots = sphere_roots(p.x, p.direction, centre, radius);
    if (p.ball == ball) return roots ? std::max(0.0, roots->second) : 0;
    // A ray that has just left the ball leads away from it: its roots lie behind.
    const bool towards = p.direction.dot(centre - p.x) > 0;
    return roots && towards ? std::max(0.0, roots->first) : infinity;
  }

  /// Moves the photon along a straight line. Balls with a smaller index than the photon's own ball
  /// contain that ball and are skipped.
  Met go_straight(Photon& p, double flight) const {
    double ray_length = exit_distance(scene_.boundary, p.x, p.direction);
    Met met = boundary;
    for (int ball = std::max(0, p.ball); ball < balls(); ++ball)
      if (const double there = length_to(ball, p); there < ray_length) {
        ray_length = there;
        met = ball;
      }
    if (flight < ray_length) {
      ray_length = flight;
      met = nothing;
    }
    p.optical_path += ray_length * index(p);
    p.x += ray_length * p.direction;
    return met;
  }

  struct Ray {
    Vec3 x, v;
    double path = 0;
  };

  /// Makes an RK4 step of dx/ds = v/|v|, dv/ds = grad n, d(optical path)/ds = n.
  Ray stepped(const Ray& r, double h) const {
    const auto derivative = [&](const Ray& at) {
      return Ray{at.v.normalized(), scene_.curved->gradient(at.x), scene_.curved->n(at.x)};
    };
    const auto moved = [&](const Ray& k, double by) {
      return Ray{r.x + by * k.x, r.v + by * k.v, r.path + by * k.path};
    };
    const Ray a = derivative(r), b = derivative(moved(a, h / 2)), c = derivative(moved(b, h / 2)),
              d = derivative(moved(c, h));
    return {r.x + h / 6 * (a.x + 2 * b.x + 2 * c.x + d.x),
            r.v + h / 6 * (a.v + 2 * b.v + 2 * c.v + d.v),
            r.path + h / 6 * (a.path + 2 * b.path + 2 * c.path + d.path)};
  }

  bool is_in(int ball, const Vec3& x) const {
    return (x - scene_.balls[ball].centre).norm() < scene_.balls[ball].radius;
  }
  /// Returns the surface that a photon in the graded index has crossed on its way to x, if any.
  Met met_at(const Vec3& x) const {
    if (is_out(scene_.boundary, x)) return boundary;
    if (balls() > 0 && !is_in(0, x)) return 0;
    for (int ball = 1; ball < balls(); ++ball)
      if (is_in(ball, x)) return ball;
    return nothing;
  }

  Met go_curved(Photon& p, double flight) const {
    Ray ray{p.x, scene_.curved->n(p.x) * p.direction, p.optical_path};
    Met met = nothing;
    for (double left = flight; left > 0 && met == nothing;) {
      double h = std::min(left, scene_.curved->step);
      Ray next = stepped(ray, h);
      met = met_at(next.x);
      if (met != nothing) {  // bisect the step to find the crossing
        double in = 0;
        for (int i = 0; i < 50; ++i) {
          const double middle = (in + h) / 2;
          const Met there = met_at(stepped(ray, middle).x);
          (there == nothing ? in : h) = middle;
          if (there != nothing) met = there;
        }
        next = stepped(ray, h);
      }
      ray = next;
      left -= h;
    }
    p.x = ray.x;
    p.direction = ray.v.normalized();
    p.optical_path = ray.path;
    return met;
  }

  /// Returns the last ball, other than ball `left`, that contains x; -1 if none does.
  int innermost_but(int left, const Vec3& x) const {
    int found = -1;
    for (int ball = 0; ball < balls(); ++ball)
      if (ball != left && is_in(ball, x)) found = ball;
    return found;
  }

  /// Refracts by Snell's law, or reflects with Fresnel's probability for unpolarised light.
  void cross(Photon& p, int ball) const {
    const Vec3 out = (p.x - scene_.balls[ball].centre).normalized();
    const bool leaves = p.ball == ball;
    Photon beyond = p;
    beyond.ball = leaves ? innermost_but(ball, p.x) : ball;
    const double ratio = index(p) / index(beyond);
    const Vec3 normal = leaves ? out : Vec3(-out);  // along the ray
    const double c1 = normal.dot(p.direction), s2 = ratio * ratio * (1 - c1 * c1);
    if (s2 < 1) {
      const double c2 = std::sqrt(1 - s2);
      const double rs = (ratio * c1 - c2) / (ratio * c1 + c2);
      const double rp = (ratio * c2 - c1) / (ratio * c2 + c1);
      if (uniform(random_) > (rs * rs + rp * rp) / 2) {
        p.direction = (ratio * p.direction + (c2 - ratio * c1) * normal).normalized();
        p.ball = beyond.ball;
        return;
      }
    }
    p.direction = (p.direction - 2 * c1 * normal).normalized();
  }

  const WalkScene& scene_;
  Random& random_;
};

}  // namespace

void walk_photons(const WalkScene& scene, const PhotonSource& source, std::uint64_t photons,
                  std::uint64_t seed, const PhotonExit& exit) {
  Random random(seed);
  Walk walk(scene, random);
  for (std::uint64_t i = 0; i < photons; ++i) {
    Photon photon = source(random);
    if (walk.run(photon)) exit(photon);
  }
}

PhotonSource point_source(const Vec3& x) {
  return [=](Random& random) { return Photon{x, any_direction(random)}; };
}

PhotonSource beam_source(const Vec3& centre, const Vec3& direction, double radius) {
  const Vec3 d = direction.normalized(), u = any_normal_to(d), v = d.cross(u);
  return [=](Random& random) {
    const double r = radius * std::sqrt(uniform(random)), angle = two_pi * uniform(random);
    return Photon{centre + r * (std::cos(angle) * u + std::sin(angle) * v), d};
  };
}

PhotonSource lambertian_source(const Vec3& centre, const Vec3& normal, double radius) {
  const Vec3 u = any_normal_to(normal), v = normal.cross(u);
  const auto on_disk = [=](double r, Random& random) -> Vec3 {
    const double angle = two_pi * uniform(random);
    return r * (std::cos(angle) * u + std::sin(angle) * v);
  };
  return [=](Random& random) {
    const double sine = std::sqrt(uniform(random));
    const Vec3 d = on_disk(sine, random) + std::sqrt(1 - sine * sine) * normal;
    return Photon{centre + on_disk(radius * std::sqrt(uniform(random)), random), d};
  };
}

double PhotonTally::error(std::size_t bin) const {
  const double m = mean(bin);
  return std::sqrt(std::max(0.0, squares_[bin] / photons_ - m * m) / photons_);
}

}  // namespace flatspeckle::oracles
