#pragma once

#include <string>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"

namespace flatspeckle {

/// The relative index of cylinders at several wavelengths, linear between them.
class IndexTable {
 public:
  /// Reads a CSV with columns wavelength, rising, and index_re, index_im. Throws InputError on
  /// anything missing or malformed, and for an index that no cylinder may have.
  explicit IndexTable(const std::string& path);

  /// Throws InputError for a wavelength beyond the table.
  Complex at(double wavelength) const;

 private:
  std::string path_;
  std::vector<double> wavelength_;
  std::vector<Complex> index_;
};

/// height exp(-r^2 / (2 width^2)), of the index.
struct IndexBlob {
  Vec2 centre;
  double height = 0, width = 1;
};

/// The refractive index n around the scatterers where it varies (conventions, C30); wavelength and
/// k are those where it is 1. It goes on beyond the domain. Or mean_field: that which the
/// scatterers themselves give the domain (C15), which exact solutions have anyway.
struct IndexField {
  enum class Kind { homogeneous, linear, parabolic, blobs, ultrasound, grid, mean_field };
  Kind kind = Kind::homogeneous;
  double origin = 1;  ///< n at the origin (linear), on the axis x = 0 (parabolic), around
  Vec2 slope;         ///< linear: n^2 = origin^2 + slope.x
  double alpha = 0;   ///< parabolic: n^2 = origin^2 - alpha^2 x^2
  std::vector<IndexBlob> blobs;                      ///< add to the index
  double sound_amplitude = 0, sound_wavenumber = 0;  ///< n + amplitude J_0(wavenumber x)
  std::string grid;  ///< file of samples in space, of which those at y = 0 count

  /// n^2 = above + slope.x - bend x^2 of the fields of which this is known here.
  bool is_around() const { return kind != Kind::mean_field; }  ///< not the scatterers' own
  bool is_quadratic() const { return kind == Kind::linear || kind == Kind::parabolic; }
  double square(Vec2 x) const {
    return origin * origin + dot(slope, x) - alpha * alpha * x.x * x.x;
  }
  std::string describe() const;
};

/// As in scene files, by kind.
inline const std::vector<std::string> index_field_words = {
    "homogeneous", "linear", "parabolic", "blobs", "ultrasound", "grid", "mean_field"};

}  // namespace flatspeckle
