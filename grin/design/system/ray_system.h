#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "grin/design/adjoint/design_ray.h"
#include "grin/design/adjoint/reading.h"
#include "grin/design/forms/field_form.h"

namespace flatspeckle::grin::design {

/// Derivatives of what is read off rays by the coefficients: K rows of each ray, at the same
/// coefficients, four neighbours at a time. All sums are made in an order that does not depend on
/// the threads.
class RayRows {
 public:
  RayRows() = default;
  /// readings: 1 or 2.
  RayRows(std::size_t rays, int readings, std::size_t coefficients);

  /// Rays of a block, to be filled in their order.
  static constexpr std::size_t block_size = 32;
  static constexpr std::size_t width = 4;
  struct Block {
    std::vector<std::uint32_t> index;  ///< of the first of four
    std::vector<float> values;         ///< of each reading by these four
    std::vector<std::size_t> end;      ///< of each ray in index

    /// Of the next ray, in the order of the coefficients.
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

  /// readings[ray K + k] = row . coefficients
  void times(std::span<const double> coefficients, std::span<double> readings) const;
  /// coefficients = sum of rows times readings
  void transposed(std::span<const double> readings, std::span<double> coefficients) const;
  /// The latter of the former, in one pass.
  void normal(std::span<const double> coefficients, std::span<double> result) const;
  /// Sum of the squares of each column, weighted by those of the readings.
  void squares(std::span<const double> weights, std::span<double> coefficients) const;

 private:
  template <class Use>
  void of_readings(const Use& use) const;
  template <class Add>
  void sum_up(std::span<double> coefficients, const Add& add) const;

  std::size_t readings_ = 1, coefficients_ = 0;
  std::vector<Block> blocks_;
};

/// What is read off all rays as a function of the coefficients of the field.
class RaySystem {
 public:
  virtual ~RaySystem() = default;

  virtual std::size_t rays() const = 0;
  virtual int readings() const = 0;  ///< of each ray

  /// All readings; nothing where a ray is lost. parts: of a step, of which so many take its place.
  virtual std::optional<std::vector<double>> trace(const FieldForm& form,
                                                   std::span<const double> coefficients,
                                                   int parts = 1) = 0;
  /// Their derivatives, along the rays that were traced last.
  virtual RayRows linearised() const = 0;
  /// The sum of those derivatives, each times a weight of its reading.
  virtual std::vector<double> gradient(std::span<const double> weights) const = 0;
};

/// One kind of reading, of each ray.
using Readings = std::variant<std::vector<ScreenReading>, std::vector<SurfaceReading>,
                              std::vector<DirectionReading>, std::vector<PathReading>,
                              std::vector<PathPerLengthReading>>;

std::unique_ptr<RaySystem> make_ray_system(std::vector<DesignRay> rays, Readings readings,
                                           const RayWalk& walk);

}  // namespace flatspeckle::grin::design
