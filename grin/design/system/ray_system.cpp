#include "grin/design/system/ray_system.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <type_traits>
#include <utility>

#include "core/run/interrupt.h"
#include "core/run/parallel.h"

namespace flatspeckle::grin::design {

namespace {

constexpr std::size_t shares = 8;  // number of groups of blocks; each group is summed separately
constexpr std::size_t width = RayRows::width;
using Block = RayRows::Block;

/// The groups of four coefficients on which one ray of a block depends: from number `begin` to
/// `end` - 1.
struct Fours {
  std::size_t begin, end;
};

/// Calls use(number of the ray within the block, its range of groups) for each ray of a block.
template <class Use>
void each_ray(const Block& block, const Use& use) {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < block.end.size(); ++r) {
    use(r, Fours{begin, block.end[r]});
    begin = block.end[r];
  }
}

/// Returns the coefficients padded with zeros, so that the last group of four is complete.
std::vector<double> padded(std::span<const double> coefficients) {
  std::vector<double> values(coefficients.begin(), coefficients.end());
  values.resize(values.size() + width - 1);
  return values;
}

template <std::size_t K>
std::array<double, K> row_products(const Block& block, const Fours& fours,
                                   const double* coefficients) {
  std::array<std::array<double, width>, K> sums{};
  for (std::size_t i = fours.begin; i < fours.end; ++i) {
    const double* const at = coefficients + block.index[i];
    const float* const values = &block.values[i * K * width];
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j)
        sums[k][j] += static_cast<double>(values[k * width + j]) * at[j];
  }
  std::array<double, K> measurements;
  for (std::size_t k = 0; k < K; ++k)
    measurements[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
  return measurements;
}

template <std::size_t K>
void add_transposed(const Block& block, const Fours& fours, const double* of_ray, double* sums) {
  for (std::size_t i = fours.begin; i < fours.end; ++i) {
    double* const at = sums + block.index[i];
    const float* const values = &block.values[i * K * width];
    std::array<double, width> sum{};
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j)
        sum[j] += of_ray[k] * static_cast<double>(values[k * width + j]);
    for (std::size_t j = 0; j < width; ++j) at[j] += sum[j];
  }
}

template <std::size_t K>
void add_squares(const Block& block, const Fours& fours, const double* weights, double* sums) {
  for (std::size_t i = fours.begin; i < fours.end; ++i)
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j) {
        const double value = block.values[(i * K + k) * width + j] * weights[k];
        sums[block.index[i] + j] += value * value;
      }
}

/// Rays with K measurements each. Each pass over all rays selects the type of the field only once,
/// by std::visit.
template <int K>
class RaySystemOf : public RaySystem {
 public:
  using Measure = std::function<RayMeasurement<K>(std::size_t, const RayState&)>;

  RaySystemOf(std::vector<DesignRay> rays, Measure measure, const RayWalk& walk)
      : rays_(std::move(rays)), measure_(std::move(measure)), walk_(walk), ends_(rays_.size()) {}

  std::size_t rays() const override { return rays_.size(); }
  int measurements() const override { return K; }

  std::optional<std::vector<double>> trace(const FieldForm& form, std::span<const double> values,
                                           int parts) override {
    if (measurements_ && parts == parts_ && std::ranges::equal(values, coefficients_))
      return measurements_;
    form_ = form;
    parts_ = parts;
    coefficients_.assign(values.begin(), values.end());
    const RayWalk walk{walk_.h / parts, walk_.most_steps * parts};
    measurements_ =
        std::visit([&](const auto& of) { return trace_in(of.field(values), walk); }, form);
    return measurements_;
  }

  RayRows linearised() const override {
    return std::visit([&](const auto& of) { return rows_in(of.field(coefficients_)); }, form_);
  }
  std::vector<double> gradient(std::span<const double> weights) const override {
    return std::visit([&](const auto& of) { return gradient_in(of.field(coefficients_), weights); },
                      form_);
  }

 private:
  template <class F>
  std::optional<std::vector<double>> trace_in(const F& field, const RayWalk& walk) {
    std::vector<double> measurements(K * rays());
    std::atomic<bool> lost = false;
    each_block([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !lost; ++i) {
        ends_[i] = follow<Pefrl>(field, rays_[i], walk);
        const auto values = measure_(i, ends_[i].state).values;
        if (ends_[i].lost || !values.allFinite()) lost = true;
        for (int k = 0; k < K; ++k) measurements[K * i + k] = values[k];
      }
    });
    if (lost) return std::nullopt;
    return measurements;
  }

  template <class F>
  RayRows rows_in(const F& field) const {
    const CoefficientShape shape = shape_of(field);
    RayRows rows(rays(), K, shape.size());
    each_block([&](std::size_t b, std::size_t begin, std::size_t end) {
      CoefficientSums<K> sums(shape);
      for (std::size_t i = begin; i < end; ++i) {
        backpropagate<Pefrl>(field, rays_[i], walk_, ends_[i], measure_(i, ends_[i].state).by,
                             sums);
        RayRows::Block& block = rows.block(b);
        sums.take([&](std::size_t number, const std::array<double, K>& derivatives) {
          block.add(number, derivatives);
        });
        block.end_ray();
      }
    });
    return rows;
  }

  /// Sums over fixed subsets of the rays, then over these subsets in order, so that the sum does
  /// not depend on the number of threads.
  template <class F>
  std::vector<double> gradient_in(const F& field, std::span<const double> weights) const {
    constexpr std::size_t parts = 16;
    const CoefficientShape shape = shape_of(field);
    std::vector<std::vector<double>> of_part(parts);
    parallel_for(parts, [&](std::size_t p) {
      CoefficientSums<1> sums(shape);
      for (std::size_t i = p * rays() / parts; i < (p + 1) * rays() / parts; ++i) {
        stop_if_interrupted();
        backpropagate<Pefrl>(field, rays_[i], walk_, ends_[i], weighted(i, &weights[K * i]), sums);
      }
      of_part[p].assign(shape.size(), 0.0);
      sums.take(
          [&](std::size_t number, const std::array<double, 1>& d) { of_part[p][number] = d[0]; });
    });
    std::vector<double> gradient(shape.size(), 0.0);
    for (const auto& part : of_part)
      for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += part[i];
    return gradient;
  }
  /// Returns the derivatives of the weighted sum of a ray's measurements with respect to the state
  /// at the ray's end.
  RayAdjoint<1> weighted(std::size_t i, const double* weights) const {
    const RayAdjoint<K> by = measure_(i, ends_[i].state).by;
    const Eigen::Map<const Eigen::Matrix<double, K, 1>> w(weights);
    RayAdjoint<1> sum;
    sum.x = by.x * w;
    sum.v = by.v * w;
    sum.arc_length = by.arc_length * w;
    sum.optical_path = by.optical_path * w;
    return sum;
  }

  template <class Body>
  void each_block(const Body& body) const {
    constexpr std::size_t size = RayRows::block_size;
    parallel_for((rays() + size - 1) / size, [&](std::size_t b) {
      stop_if_interrupted();
      body(b, b * size, std::min((b + 1) * size, rays()));
    });
  }

  std::vector<DesignRay> rays_;
  Measure measure_;
  RayWalk walk_;
  std::vector<FollowedRay> ends_;
  FieldForm form_;
  int parts_ = 0;
  std::vector<double> coefficients_;
  std::optional<std::vector<double>> measurements_;  ///< measurements of the last trace
};

}  // namespace

RayRows::RayRows(std::size_t rays, int measurements, std::size_t coefficients)
    : measurements_(measurements),
      coefficients_(coefficients),
      blocks_((rays + block_size - 1) / block_size) {}

/// Calls use(K), where K is the number of measurements per ray as an integral constant.
template <class Use>
void RayRows::of_measurements(const Use& use) const {
  if (measurements_ == 1) return use(std::integral_constant<std::size_t, 1>());
  use(std::integral_constant<std::size_t, 2>());
}

/// Calls add(block, number of its first ray, sums) for the blocks of each group of blocks in order,
/// then adds up the sums of all groups.
template <class Add>
void RayRows::sum_up(std::span<double> coefficients, const Add& add) const {
  std::vector<std::vector<double>> sums(shares);
  parallel_for(shares, [&](std::size_t s) {
    sums[s].assign(coefficients_ + width - 1, 0.0);
    for (std::size_t b = s * blocks_.size() / shares; b < (s + 1) * blocks_.size() / shares; ++b) {
      stop_if_interrupted();
      add(blocks_[b], b * block_size, sums[s].data());
    }
  });
  std::fill(coefficients.begin(), coefficients.end(), 0.0);
  for (const auto& share : sums)
    for (std::size_t i = 0; i < coefficients_; ++i) coefficients[i] += share[i];
}

void RayRows::times(std::span<const double> coefficients, std::span<double> measurements) const {
  const auto values = padded(coefficients);
  of_measurements([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    parallel_for(blocks_.size(), [&](std::size_t b) {
      stop_if_interrupted();
      each_ray(blocks_[b], [&](std::size_t r, const Fours& fours) {
        std::ranges::copy(row_products<K>(blocks_[b], fours, values.data()),
                          &measurements[(b * block_size + r) * K]);
      });
    });
  });
}

void RayRows::transposed(std::span<const double> measurements,
                         std::span<double> coefficients) const {
  of_measurements([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_transposed<K>(block, fours, &measurements[(first + r) * K], sums);
      });
    });
  });
}

void RayRows::normal(std::span<const double> coefficients, std::span<double> result) const {
  const auto values = padded(coefficients);
  of_measurements([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(result, [&](const Block& block, std::size_t, double* sums) {
      each_ray(block, [&](std::size_t, const Fours& fours) {
        const auto measurements = row_products<K>(block, fours, values.data());
        add_transposed<K>(block, fours, measurements.data(), sums);
      });
    });
  });
}

void RayRows::squares(std::span<const double> weights, std::span<double> coefficients) const {
  of_measurements([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_squares<K>(block, fours, &weights[(first + r) * K], sums);
      });
    });
  });
}

std::unique_ptr<RaySystem> make_ray_system(std::vector<DesignRay> rays, Measurements measurements,
                                           const RayWalk& walk) {
  return std::visit(
      [&]<class Each>(std::vector<Each>& of_rays) -> std::unique_ptr<RaySystem> {
        return std::make_unique<RaySystemOf<Each::count>>(
            std::move(rays),
            [all = std::move(of_rays)](std::size_t i, const RayState& end) { return all[i](end); },
            walk);
      },
      measurements);
}

}  // namespace flatspeckle::grin::design
