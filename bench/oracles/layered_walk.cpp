#include "bench/oracles/layered_walk.h"

#include <algorithm>
#include <cmath>

#include "core/numbers/random.h"
#include "flatland/media/faces.h"
#include "grin/media/scattering/start_directions.h"

namespace flatspeckle::oracles {

namespace {

using grin::Vec3;

struct LayeredPhoton {
  Vec3 x{0, 0, 0}, direction{0, 0, 1};
  double weight = 1, decay = 0;  ///< decay: sum of diffusion (1 - cos)
  std::size_t layer = 0;
};

class LayeredTracing {
 public:
  LayeredTracing(const LayeredWalk& walk, RandomStream& random) : walk_(walk), random_(random) {
    for (const WalkLayer& layer : walk.layers) tops_.push_back(tops_.back() + layer.thickness);
  }

  /// Calls leave(photon) for all photons that leave from one that enters.
  template <typename F>
  void trace(const F& leave) {
    waiting_.assign(1, {});
    while (!waiting_.empty()) {
      LayeredPhoton photon = waiting_.back();
      waiting_.pop_back();
      while (true) {
        if (!collide(photon)) {
          if (photon.layer == 0 && photon.direction[2] < 0) leave(photon);
          break;
        }
        if (!window(photon)) break;
      }
    }
  }

 private:
  /// Moves a photon to its next collision, and turns it there; false if it leaves the layers.
  bool collide(LayeredPhoton& photon) {
    double depth = -std::log(random_.uniform());
    while (true) {
      const WalkLayer& own = walk_.layers[photon.layer];
      const double down = photon.direction[2], face = tops_[photon.layer + (down > 0 ? 1 : 0)],
                   to_face = std::max(0.0, (face - photon.x[2]) / down),
                   length = std::min(depth / own.mu_s, to_face);
      photon.x += length * photon.direction;
      photon.weight *= std::exp(-own.mu_a * length);
      if (length < to_face) {
        turn(photon, own);
        return true;
      }
      depth -= length * own.mu_s;
      photon.x[2] = face;
      if (!cross(photon)) return false;
    }
  }

  /// Moves a photon over a face; false if it leaves the layers.
  bool cross(LayeredPhoton& photon) {
    const double cosine = photon.direction[2];
    if (cosine > 0) return ++photon.layer < walk_.layers.size();
    if (photon.layer > 0) {
      --photon.layer;
      return true;
    }
    const Face surface{walk_.index, 1, Polarisation::unpolarised};
    if (random_.uniform() >= surface.reflectance(-cosine)) return false;
    photon.direction[2] = -cosine;
    return true;
  }

  void turn(LayeredPhoton& photon, const WalkLayer& layer) {
    const double g = layer.g, u = random_.uniform();
    const double ratio = (1 - g * g) / (1 - g + 2 * g * u),
                 cosine = g == 0 ? 2 * u - 1 : (1 + g * g - ratio * ratio) / (2 * g);
    photon.decay += layer.diffusion * (1 - cosine);
    photon.direction = grin::random_turn(photon.direction, 1 - cosine, random_);
  }

  /// Splits a photon, or ends it by Russian roulette; returns whether it goes on.
  bool window(LayeredPhoton& photon) {
    const double distance = std::min(photon.x.norm(), 1.1 * walk_.distances.back()),
                 importance = std::exp(walk_.growth * distance),
                 expected = photon.weight * importance;
    if (expected < 0.4 && random_.uniform() > expected) return false;
    if (expected > 0.4 && expected < 2.5) return true;
    photon.weight = 1 / importance;
    if (expected < 1) return true;
    const int copies = static_cast<int>(expected + random_.uniform());
    for (int copy = 1; copy < copies; ++copy) waiting_.push_back(photon);
    return true;
  }

  const LayeredWalk& walk_;
  RandomStream& random_;
  std::vector<double> tops_{0};
  std::vector<LayeredPhoton> waiting_;
};

}  // namespace

std::vector<LayeredWalk::Ring> LayeredWalk::trace(int batches, std::uint64_t seed) const {
  constexpr int photons = 1000;
  const std::size_t values = 1 + delays.size();
  std::vector<double> sums(distances.size() * values), squares(sums.size());
  for (int batch = 0; batch < batches; ++batch) {
    RandomStream random(seed, 0, static_cast<std::uint64_t>(batch));
    LayeredTracing walk(*this, random);
    std::vector<double> own(sums.size());
    for (int n = 0; n < photons; ++n)
      walk.trace([&](const LayeredPhoton& photon) {
        const double distance = std::hypot(photon.x[0], photon.x[1]);
        for (std::size_t ring = 0; ring < distances.size(); ++ring) {
          if (std::abs(distance - distances[ring]) > width / 2) continue;
          own[ring * values] += photon.weight / photons;
          for (std::size_t t = 0; t < delays.size(); ++t)
            own[ring * values + 1 + t] +=
                photon.weight * std::exp(-2 * delays[t] * photon.decay) / photons;
        }
      });
    for (std::size_t n = 0; n < own.size(); ++n) {
      sums[n] += own[n];
      squares[n] += own[n] * own[n];
    }
  }
  std::vector<Ring> rings(distances.size());
  for (std::size_t n = 0; n < sums.size(); ++n) {
    const double mean = sums[n] / batches, square = squares[n] / batches;
    rings[n / values].value.push_back(mean);
    rings[n / values].error.push_back(std::sqrt((square - mean * mean) / (batches - 1)));
  }
  return rings;
}

}  // namespace flatspeckle::oracles
