#pragma once

namespace flatspeckle::mc {

/// How a field differs from another besides its light and view.
struct FieldChange {
  double delay = 0;  ///< k^2 D tau: recorded later, as the scatterers diffuse (brownian.h)
  /// Of its wavenumber, relative; its view is turned so that transverse momenta match. Attenuation
  /// and scattering stay those of k.
  double shift = 0;
};

}  // namespace flatspeckle::mc
