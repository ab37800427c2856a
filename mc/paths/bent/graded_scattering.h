#pragma once

#include <memory>
#include <utility>

#include "mc/paths/bent/graded_medium.h"
#include "mc/paths/endpoint_factors/end_factors.h"
#include "mc/paths/endpoint_factors/varying_scattering.h"

namespace flatspeckle::mc {

/// Scattering (scattering.h) in a medium whose index varies; flights between scatterers are curved.
class GradedScattering {
 public:
  using Direction = Vec2;

  GradedScattering(AnyScattering form, std::shared_ptr<const GradedMedium> medium)
      : form_(std::move(form)), medium_(std::move(medium)) {}

  const AnyScattering& form() const { return form_; }
  const GradedMedium& medium() const { return *medium_; }

 private:
  AnyScattering form_;
  std::shared_ptr<const GradedMedium> medium_;
};

inline const AnyScattering& local(const GradedScattering& scattering, Vec2) {
  return scattering.form();
}

template <typename Scattering>
constexpr bool bends = false;
template <>
inline constexpr bool bends<GradedScattering> = true;

}  // namespace flatspeckle::mc
