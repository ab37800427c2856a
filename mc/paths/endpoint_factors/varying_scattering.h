#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "flatland/scene/scene.h"
#include "mc/paths/endpoint_factors/scattering.h"
#include "mc/paths/endpoint_factors/space_scattering.h"

namespace flatspeckle::mc {

/// Scattering in any of the forms of scattering.h and space_scattering.h, selected at run time.
class AnyScattering {
 public:
  using Form = std::variant<IsotropicScattering, HenyeyGreensteinScattering, TabulatedScattering,
                            IsotropicInSpace, SpaceScattering, HenyeyGreensteinInSpace,
                            TabulatedSpaceScattering>;

  explicit AnyScattering(Form form) : form_(std::move(form)) {}

  double density(Vec from, Vec to) const {
    return std::visit([&](const auto& form) { return form.density(from, to); }, form_);
  }
  Complex amplitude(Vec from, Vec to) const {
    return std::visit([&](const auto& form) { return Complex(form.amplitude(from, to)); }, form_);
  }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    std::visit([&](const auto& form) { form.towards(from, to, out); }, form_);
  }
  Vec sample(Vec from, RandomStream& random) const {
    return std::visit([&](const auto& form) { return form.sample(from, random); }, form_);
  }

 private:
  Form form_;
};

/// Scattering in a medium that varies: each material has its own form.
class VaryingScattering {
 public:
  /// forms: one for each material of the profile, in the same order.
  VaryingScattering(const MediumProfile& profile, std::vector<AnyScattering> forms)
      : profile_(profile), forms_(std::move(forms)) {}

  const AnyScattering& at(Vec x) const { return forms_[profile_.material_at(x)]; }

 private:
  const MediumProfile& profile_;
  std::vector<AnyScattering> forms_;
};

/// Returns the scattering at a place: the same object everywhere unless the medium varies.
template <typename Scattering>
const Scattering& local(const Scattering& scattering, Vec) {
  return scattering;
}
inline const AnyScattering& local(const VaryingScattering& scattering, Vec x) {
  return scattering.at(x);
}

template <typename Scattering>
constexpr bool varies = false;
template <>
inline constexpr bool varies<VaryingScattering> = true;

}  // namespace flatspeckle::mc
