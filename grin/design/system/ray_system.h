#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/measurement.h"
#include "grin/design/forms/field_form.h"

namespace flatspeckle::grin::design {

/// Sparse matrix of the derivatives of the rays' measurements with respect to the coefficients. A
/// ray with K measurements has K rows of the same sparsity. The derivatives are stored in groups of
/// four neighbouring coefficients. All sums are made in an order that does not depend on the number
/// of threads.
class RayRows {
 public:
  RayRows() = default;
  /// measurements: number of measurements per ray, 1 or 2.
  RayRows(std::size_t rays, int measurements, std::size_t coefficients);

  /// Number of rays in a block of rows. Rays are added to a block in order.
  static constexpr std::size_t block_size = 32;
  static constexpr std::size_t width = 4;
  struct Block {
    std::vector<std::uint32_t> index;  ///< index of the first coefficient of each group of four
    /// Derivatives of each measurement with respect to the four coefficients of each group.
    std::vector<float> values;
    std::vector<std::size_t> end;  ///< for each ray, the end of its groups in `index`

    /// Adds derivatives of the next ray; must be called in the order of the coefficients.
    template <std::size_t K>
    void add(std::size_t coefficient, const std::array<double, K>& derivatives) {
      const std::size_t begin = end.empty() ? 0 : end.back();
      if (index.size() == begin || coefficient >= index.back() + width) {
        index.push_back(static_cast<std::uint32_t>(coefficient));
        values.resize(values.size() + K * width);
      }
      float* const four = &values[(index.size() - 1) * K * width] + (coefficient - index.back());
      for (std::size_t k = 0; k < K; ++k) four[k * width] = static_cast<float>(derivatives[k]);
    }
    void end_ray() { end.push_back(index.size()); }
  };
  Block& block(std::size_t b) { return blocks_[b]; }

  /// Multiplies the matrix by `coefficients`: measurements[ray * K + k] is the product of row k of
  /// a ray and the coefficients.
  void times(std::span<const double> coefficients, std::span<double> measurements) const;
  /// Multiplies the transposed matrix by `measurements`: the result is the sum over all rows of the
  /// row times its measurement.
  void transposed(std::span<const double> measurements, std::span<double> coefficients) const;
  /// Computes transposed(times(coefficients)) in one pass over the rows.
  void normal(std::span<const double> coefficients, std::span<double> result) const;
  /// Computes, for each column of the matrix, the sum of its squared elements, each multiplied by
  /// the squared weight of its measurement.
  void squares(std::span<const double> weights, std::span<double> coefficients) const;

 private:
  template <class Use>
  void of_measurements(const Use& use) const;
  template <class Add>
  void sum_up(std::span<double> coefficients, const Add& add) const;

  std::size_t measurements_ = 1, coefficients_ = 0;
  std::vector<Block> blocks_;
};

/// Measurements of all rays as a function of the field's coefficients.
class RaySystem {
 public:
  virtual ~RaySystem() = default;

  virtual std::size_t rays() const = 0;
  virtual int measurements() const = 0;  ///< number of measurements per ray

  /// Returns all measurements; nullopt if a ray is lost. Each integration step is divided into
  /// `parts` equal substeps.
  virtual std::optional<std::vector<double>> trace(const FieldForm& form,
                                                   std::span<const double> coefficients,
                                                   int parts = 1) = 0;
  /// Returns the derivatives of the measurements with respect to the coefficients, for the last
  /// traced rays.
  virtual RayRows linearised() const = 0;
  /// Returns the gradient of the weighted sum of all measurements with respect to the coefficients,
  /// for the last traced rays.
  virtual std::vector<double> gradient(std::span<const double> weights) const = 0;
};

/// Measurements of one kind, one for each ray.
using Measurements = std::variant<std::vector<ScreenMeasurement>, std::vector<SurfaceMeasurement>,
                                  std::vector<DirectionMeasurement>, std::vector<PathMeasurement>,
                                  std::vector<PathPerLengthMeasurement>>;

std::unique_ptr<RaySystem> make_ray_system(std::vector<DesignRay> rays, Measurements measurements,
                                           const RayWalk& walk);

}  // namespace flatspeckle::grin::design
