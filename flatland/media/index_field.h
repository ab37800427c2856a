#pragma once

#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// Relative index of the cylinders, tabulated against wavelength and interpolated linearly.
class IndexTable {
 public:
  /// Reads a CSV file with columns wavelength (increasing), index_re and index_im. Throws
  /// InputError if anything is missing or malformed, and for an index that index_fault() rejects.
  explicit IndexTable(const std::string& path);

  /// Returns the index at a wavelength. Throws InputError for a wavelength outside the table.
  Complex at(double wavelength) const;

 private:
  std::string path_;
  std::vector<double> wavelength_;
  std::vector<Complex> index_;
};

/// Gaussian contribution to the index: height exp(-r^2 / (2 width^2)) at distance r from the
/// centre.
struct IndexBlob {
  Vec centre;
  double height = 0, width = 1;
};

/// Refractive index n of the medium around the scatterers, if it varies in space (conventions,
/// C30). It also applies outside the domain. The wavelength and k of the scene are those at n = 1.
/// For mean_field, n is the effective index that the scatterers themselves give the domain (C15);
/// exact solutions need no index field to contain this effect.
struct IndexField {
  enum class Kind { homogeneous, linear, parabolic, blobs, ultrasound, grid, mean_field };
  Kind kind = Kind::homogeneous;
  double origin = 1;  ///< n at the origin (linear), at x = 0 (parabolic), or of the background
  Vec gradient;       ///< for linear: n^2 = origin^2 + dot(gradient, position)
  double alpha = 0;   ///< for parabolic: n^2 = origin^2 - alpha^2 x^2
  std::vector<IndexBlob> blobs;  ///< for blobs: Gaussians that are added to origin
  /// for ultrasound: n = origin + sound_amplitude J_0(sound_wavenumber x)
  double sound_amplitude = 0, sound_wavenumber = 0;
  std::string grid;  ///< for grid: file of samples of n in 3D; those at y = 0 are used

  /// Whether n describes the surrounding medium, not the mean field of the scatterers.
  bool is_around() const { return kind != Kind::mean_field; }
  /// Whether n^2 is a polynomial of at most second degree in position; square() returns its value.
  bool is_quadratic() const { return kind == Kind::linear || kind == Kind::parabolic; }
  double square(Vec x) const {
    return origin * origin + dot(gradient, x) - alpha * alpha * x.x * x.x;
  }
  std::string describe() const;
};

/// Accepted values of the key `index_field`, in the order of IndexField::Kind.
inline const std::vector<std::string> index_field_words = {
    "homogeneous", "linear", "parabolic", "blobs", "ultrasound", "grid", "mean_field"};

}  // namespace flatspeckle
