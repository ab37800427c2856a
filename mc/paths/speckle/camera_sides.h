#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/scene/scene.h"
#include "mc/paths/speckle/spreading_axis.h"
#include "mc/paths/walk/walks.h"

namespace flatspeckle::mc {

/// End of a path: light reaches the last scatterer at x along `arrival`. Its phase is that of a
/// scatterer at `place`, which differs from x if the scatterer has moved.
struct PathEnd {
  Vec x, arrival, place;
  int wave = 0;  ///< number of reflections at faces of the light that leaves (FaceWaves::view)

  PathEnd(Vec position, Vec along) : PathEnd(position, along, position) {}
  PathEnd(Vec position, Vec along, Vec moved) : x(position), arrival(along), place(moved) {}
};

/// End with its factors in successive fields of a sum, the first of which is `field`.
struct WeightedEnd {
  PathEnd end;
  std::size_t field;
  std::span<const Complex> factors;
};

/// Numbers of nodes of a CameraSum and width of its kernel.
struct CameraResolution {
  std::size_t nodes = 1;       ///< Chebyshev nodes along each side of the camera
  std::size_t side_nodes = 1;  ///< Chebyshev nodes along a column or a row, for CameraSides
  int width = 4;               ///< width of the spreading kernel, in grid points
  double error = 0;            ///< rms over pixels and ends of paths, relative to the rms field
  double bytes = 0;            ///< memory for the grids of one field
  Vec margin{};                ///< largest distance of places of ends from the box
};

/// Factors of ends of paths in a homogeneous box towards a camera, whose rays may leave through a
/// side of the box. Attenuations are exp(-mu_t d / 2), with the distance d to the face of the box
/// or to a side.
class CameraBox {
 public:
  CameraBox(const PathWalks& walks, const FarCamera& camera);

  const PathWalks& walks() const { return walks_; }
  const FarCamera& camera() const { return camera_; }
  const Domain& box() const { return box_; }
  double k() const { return k_; }
  double mu_t() const { return mu_t_; }
  /// Returns the direction with these transverse direction cosines, on the side of the camera.
  Vec towards(double x, double y) const;
  /// Returns the directions of a square grid [y][x]. at: coordinates of its columns and rows, from
  /// -1 to 1 across the camera.
  Directions square(const std::vector<double>& at) const;
  Vec pixel(std::size_t row, std::size_t column) const {
    return towards(camera_.cosine(camera_.axis.x, column), camera_.cosine(camera_.axis.y, row));
  }
  /// Returns the distance from x to the face of the camera, along z.
  double depth_of(Vec x) const { return camera_.axis.z > 0 ? box_.depth - x.z : x.z; }

 private:
  const PathWalks& walks_;
  FarCamera camera_;
  Domain box_;
  double k_, mu_t_;
};

/// Sums over the lines of pixels towards which rays leave through one pair of sides of a box: the
/// columns for the sides |x| = width/2, the rows for |y| = height/2. To the pixels of such a line
/// it adds what they have more than with the attenuation up to the face,
///   c A (exp(-mu_t d_side / 2) - exp(-mu_t d_face / 2)) exp(-i k v.x).
/// On a line, d_side is constant and d_face is smooth, so that the sum has the form of a CameraSum
/// in one dimension.
class LineSums {
 public:
  enum class Leaves { none, part, whole };

  LineSums(const CameraBox& box, bool columns, const CameraResolution& resolution,
           std::size_t fields);

  /// Whether rays from x towards the pixels of a line leave through the sides.
  Leaves leaves(Vec x, std::size_t line) const;
  /// Returns the distance to the side from x towards the pixels of a line.
  double distance(Vec x, std::size_t line) const { return gap(x, line) / std::abs(cosine_[line]); }
  /// Whether there is a line, towards which all or some rays leave through the sides.
  bool reached(Vec x) const;
  /// Adds an end to all lines towards which all rays leave through the sides.
  void add(const WeightedEnd& weighted);
  /// Adds the fields to `out`, [field][y][x].
  void finish(std::span<Complex> out) const;
  /// Returns the mean over the lines of |error|^2 of the interpolation along lines, for an end.
  double squared_error(const PathEnd& end);

  /// Place across the lines by which an end sorts; ends with similar places share memory.
  double place(const PathEnd& end) const;

 private:
  double gap(Vec x, std::size_t line) const {
    return cosine_[line] > 0 ? half_ - x.*along_ : half_ + x.*along_;
  }
  /// Computes the factors of an end, without their fast phase, towards `directions_`, which belong
  /// to the lines `line_`.
  void find_factors(const PathEnd& end);
  void choose_lines(Vec x);
  void choose_directions(const std::vector<double>& across);

  const CameraBox& box_;
  double Vec::*along_;
  double Vec::*across_;
  double half_, tangent_;  ///< tangent_: that of the axis of the camera, across the lines
  std::size_t fields_;
  std::vector<double> cosine_;        ///< component along the axis of each line
  std::vector<double> least_, most_;  ///< range of |v_z| over each line
  std::vector<double> node_;
  SpreadingAxis axis_;
  std::vector<Complex> grid_;  ///< [field][line][point][node]
  // Values of the last end
  std::vector<std::size_t> lines_;
  Directions directions_{0};
  std::vector<double> phase_, by_side_, by_face_, zero_;
  std::vector<Complex> value_, scaled_;
};

/// Adds to the sums of a camera what pixels have more than with the attenuation up to the face,
/// because rays towards them leave a box through a side: by LineSums for whole columns and rows,
/// one by one for single pixels.
class CameraSides {
 public:
  CameraSides(const CameraBox& box, const CameraResolution& resolution, std::size_t fields);

  void add(std::span<const WeightedEnd> ends);
  /// Adds the fields to `out`, [field][y][x].
  void finish(std::span<Complex> out) const;

 private:
  /// Chooses the pixels that do not yet receive what leaves towards them from x. What they lack is
  /// exp(-mu_t wanted / 2) - exp(-mu_t added / 2), with distances `wanted` and `added`.
  void choose_pixels(Vec x);
  void add_pixels(const WeightedEnd& weighted);

  const CameraBox& box_;
  LineSums columns_, rows_;
  std::vector<Vec> direction_;      ///< of each pixel
  std::vector<Complex> field_;      ///< of single pixels, [field][y][x]
  std::vector<double> per_cosine_;  ///< 1 / |v_z| of each pixel
  // Values of the last end
  std::vector<std::size_t> pixels_;
  Directions directions_{0};
  std::vector<double> wanted_, added_, phase_, zero_;
  std::vector<Complex> value_;
};

}  // namespace flatspeckle::mc
