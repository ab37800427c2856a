#include "mc/paths/estimators/reflection_theory.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/numbers/gauss.h"
#include "core/numbers/log_sinh.h"
#include "core/result/result_group.h"
#include "mc/paths/walk/scene_scattering.h"
#include "mc/theory/diffusion.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

namespace {

/// Unit directions of a light and of a reflected view.
struct Reflection {
  Vec light, view;
};

class ReflectedLight {
 public:
  explicit ReflectedLight(const Scene& scene)
      : depth_(scene.domain.depth), k_(scene.k), medium_(scene.medium) {
    with_scattering(scene, phase_of(scene), [&](const auto& scattering) {
      amplitude_ = [scattering](Vec from, Vec to) -> Complex {
        return scattering.amplitude(from, to);
      };
    });
  }

  /// Returns the covariance of the fields of two reflections, up to a factor that is common to all
  /// pairs. q: transverse wavenumber of the tilt between them.
  Complex covariance(const Reflection& a, const Reflection& b, double q) const {
    // Half the sum of 1/cos, because amplitudes decay half as fast as power.
    const double in = (1 / a.light.z + 1 / b.light.z) / 2, out = -(1 / a.view.z + 1 / b.view.z) / 2;
    return once(a, b, in + out) + diffuse(in, out, q);
  }

 private:
  /// Returns the covariance of light scattered once: mu_s A A'* int exp(-z (mu_t slant - i phase))
  /// dz.
  Complex once(const Reflection& a, const Reflection& b, double slant) const {
    const double phase = k_ * (a.light.z - a.view.z - b.light.z + b.view.z);
    const Complex decay(medium_.mu_t * slant, -phase);
    return medium_.mu_s * amplitude_(a.light, a.view) * std::conj(amplitude_(b.light, b.view)) *
           (1.0 - std::exp(-decay * depth_)) / decay;
  }

  /// Returns the covariance of diffuse light: the integral of the product of the source strength
  /// mu_s (1 - g), the Green function of diffusion, and the emission strength mu_s (1 - g) / (2
  /// pi).
  double diffuse(double in, double out, double q) const {
    const double length = medium_.transport_mean_free_path(),
                 reduced = medium_.mu_s * (1 - medium_.g),
                 deepest = std::min(depth_, 40 * length / std::max(in + out, 2.0));
    const QuadratureRule outer = gauss_legendre(40), inner = gauss_legendre(24);
    // The outer integral is over the depth of the deeper one of the first and last scatterers, the
    // inner integral over the depth of the other one.
    double integral = 0;
    for (std::size_t i = 0; i < outer.node.size(); ++i) {
      const double far = deepest * outer.node[i] * outer.node[i],
                   step = 2 * deepest * outer.node[i] * outer.weight[i];
      for (std::size_t j = 0; j < inner.node.size(); ++j) {
        const double near = far * inner.node[j];
        const double attenuation = std::exp(-(in * near + out * far) / length) +
                                   std::exp(-(out * near + in * far) / length);
        integral += step * far * inner.weight[j] * attenuation * green(near, far, q);
      }
    }
    return reduced * reduced * integral / (length * std::numbers::pi);
  }

  /// Returns the Green function of u'' = Q^2 u that is 0 at the extrapolation length outside each
  /// face, for the depths near <= far.
  double green(double near, double far, double q) const {
    const double beyond = extrapolation_length(medium_),
                 length = medium_.transport_mean_free_path(), mu_a = medium_.mu_t - medium_.mu_s;
    const double rate = std::max(std::sqrt(q * q + 2 * mu_a / length), 1e-5 / depth_);
    return std::exp(log_sinh(rate * (near + beyond)) + log_sinh(rate * (depth_ + beyond - far)) -
                    log_sinh(rate * (depth_ + 2 * beyond))) /
           rate;
  }

  double depth_, k_;
  const BulkMedium& medium_;
  std::function<Complex(Vec, Vec)> amplitude_;
};

Reflection reflection(const CovarianceRequest& request, std::uint32_t channel) {
  const Channel c = request.channels[channel];
  return {request.lights[c.light].direction(), request.views[c.view].direction()};
}

/// Whether a request has tilts with matched views, for plane waves on a homogeneous 2D slab.
bool is_matched(const Scene& scene) {
  return scene.request.kind == CovarianceRequest::Kind::memory_effect &&
         scene.domain.kind == Domain::Kind::slab && !scene.profile && !scene.faces &&
         scene.medium.dimension == 2;
}

}  // namespace

std::vector<double> reflected_correlation_theory(const Scene& scene) {
  const CovarianceRequest& request = scene.request;
  if (!is_matched(scene) || scene.faces) return {};
  const std::vector<std::size_t> views = view_groups(request).back();
  if (std::cos(request.views[views.front()].angle) > 0) return {};
  const ReflectedLight light(scene);
  std::vector<Complex> entries(request.entries.size());
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const bool moved = e < request.moves * request.reference_views;
    entries[e] = light.covariance(reflection(request, request.entries[e].a),
                                  reflection(request, request.entries[e].b),
                                  moved ? request.tilt_q[e / request.reference_views] : 0);
  }
  std::vector<double> correlation;
  for (const Complex value : field_correlation(request, entries, views))
    correlation.push_back(value.real());
  return correlation;
}

const DatasetTable reflection_theory_table{
    "reflection theory",
    {{"reflection_theory", Data::real, "tilt", "1",
      "theoretical C_E of the reflected, matched views: light scattered once and diffuse light"}}};

void write_reflection_theory(ResultFile& file, const Scene& scene) {
  const auto theory = reflected_correlation_theory(scene);
  if (!theory.empty())
    ResultGroup(file, reflection_theory_table, "").put("reflection_theory", theory);
}

}  // namespace flatspeckle::mc
