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

constexpr std::size_t shares = 8;  // of the blocks, each summed up by itself
constexpr std::size_t width = RayRows::width;
using Block = RayRows::Block;

/// Of a ray, in its block.
struct Fours {
  std::size_t begin, end;
};

/// use(ray in the block, its fours) of each.
template <class Use>
void each_ray(const Block& block, const Use& use) {
  std::size_t begin = 0;
  for (std::size_t r = 0; r < block.end.size(); ++r) {
    use(r, Fours{begin, block.end[r]});
    begin = block.end[r];
  }
}

/// With room for the last four.
std::vector<double> padded(std::span<const double> coefficients) {
  std::vector<double> values(coefficients.begin(), coefficients.end());
  values.resize(values.size() + width - 1);
  return values;
}

template <std::size_t K>
std::array<double, K> read(const Block& block, const Fours& fours, const double* coefficients) {
  std::array<std::array<double, width>, K> sums{};
  for (std::size_t i = fours.begin; i < fours.end; ++i) {
    const double* const at = coefficients + block.index[i];
    const float* const values = &block.values[i * K * width];
    for (std::size_t k = 0; k < K; ++k)
      for (std::size_t j = 0; j < width; ++j)
        sums[k][j] += static_cast<double>(values[k * width + j]) * at[j];
  }
  std::array<double, K> readings;
  for (std::size_t k = 0; k < K; ++k)
    readings[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
  return readings;
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

/// Rays of which K numbers are read; a visit chooses the field, once for each pass over all rays.
template <int K>
class RaySystemOf : public RaySystem {
 public:
  using Reader = std::function<Reading<K>(std::size_t, const RayState&)>;

  RaySystemOf(std::vector<DesignRay> rays, Reader reader, const RayWalk& walk)
      : rays_(std::move(rays)), read_(std::move(reader)), walk_(walk), ends_(rays_.size()) {}

  std::size_t rays() const override { return rays_.size(); }
  int readings() const override { return K; }

  std::optional<std::vector<double>> trace(const FieldForm& form, std::span<const double> values,
                                           int parts) override {
    if (readings_ && parts == parts_ && std::ranges::equal(values, coefficients_)) return readings_;
    form_ = form;
    parts_ = parts;
    coefficients_.assign(values.begin(), values.end());
    const RayWalk walk{walk_.h / parts, walk_.most_steps * parts};
    readings_ = std::visit([&](const auto& of) { return trace_in(of.field(values), walk); }, form);
    return readings_;
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
    std::vector<double> readings(K * rays());
    std::atomic<bool> lost = false;
    each_block([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !lost; ++i) {
        ends_[i] = follow<Pefrl>(field, rays_[i], walk);
        const auto values = read_(i, ends_[i].state).values;
        if (ends_[i].lost || !values.allFinite()) lost = true;
        for (int k = 0; k < K; ++k) readings[K * i + k] = values[k];
      }
    });
    if (lost) return std::nullopt;
    return readings;
  }

  template <class F>
  RayRows rows_in(const F& field) const {
    const CoefficientShape shape = shape_of(field);
    RayRows rows(rays(), K, shape.size());
    each_block([&](std::size_t b, std::size_t begin, std::size_t end) {
      CoefficientSums<K> sums(shape);
      for (std::size_t i = begin; i < end; ++i) {
        pull_back<Pefrl>(field, rays_[i], walk_, ends_[i], read_(i, ends_[i].state).by, sums);
        RayRows::Block& block = rows.block(b);
        sums.take([&](std::size_t number, const std::array<double, K>& derivatives) {
          block.add(number, derivatives);
        });
        block.end_ray();
      }
    });
    return rows;
  }

  /// Adds up parts of the rays, then these in turn: the same sum for any number of threads.
  template <class F>
  std::vector<double> gradient_in(const F& field, std::span<const double> weights) const {
    constexpr std::size_t parts = 16;
    const CoefficientShape shape = shape_of(field);
    std::vector<std::vector<double>> of_part(parts);
    parallel_for(parts, [&](std::size_t p) {
      CoefficientSums<1> sums(shape);
      for (std::size_t i = p * rays() / parts; i < (p + 1) * rays() / parts; ++i) {
        stop_if_interrupted();
        pull_back<Pefrl>(field, rays_[i], walk_, ends_[i], weighted(i, &weights[K * i]), sums);
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
  /// Derivatives by the end of a ray of the weighted sum of its readings.
  RayAdjoint<1> weighted(std::size_t i, const double* weights) const {
    const RayAdjoint<K> by = read_(i, ends_[i].state).by;
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
  Reader read_;
  RayWalk walk_;
  std::vector<FollowedRay> ends_;
  FieldForm form_;
  int parts_ = 0;
  std::vector<double> coefficients_;
  std::optional<std::vector<double>> readings_;  ///< of the last trace
};

}  // namespace

RayRows::RayRows(std::size_t rays, int readings, std::size_t coefficients)
    : readings_(readings),
      coefficients_(coefficients),
      blocks_((rays + block_size - 1) / block_size) {}

/// use(K) of the type that says how many readings there are.
template <class Use>
void RayRows::of_readings(const Use& use) const {
  if (readings_ == 1) return use(std::integral_constant<std::size_t, 1>());
  use(std::integral_constant<std::size_t, 2>());
}

/// add(block, its first ray, sums): sums of the blocks of a share in turn, then of the shares.
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

void RayRows::times(std::span<const double> coefficients, std::span<double> readings) const {
  const auto values = padded(coefficients);
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    parallel_for(blocks_.size(), [&](std::size_t b) {
      stop_if_interrupted();
      each_ray(blocks_[b], [&](std::size_t r, const Fours& fours) {
        std::ranges::copy(read<K>(blocks_[b], fours, values.data()),
                          &readings[(b * block_size + r) * K]);
      });
    });
  });
}

void RayRows::transposed(std::span<const double> readings, std::span<double> coefficients) const {
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_transposed<K>(block, fours, &readings[(first + r) * K], sums);
      });
    });
  });
}

void RayRows::normal(std::span<const double> coefficients, std::span<double> result) const {
  const auto values = padded(coefficients);
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(result, [&](const Block& block, std::size_t, double* sums) {
      each_ray(block, [&](std::size_t, const Fours& fours) {
        const auto readings = read<K>(block, fours, values.data());
        add_transposed<K>(block, fours, readings.data(), sums);
      });
    });
  });
}

void RayRows::squares(std::span<const double> weights, std::span<double> coefficients) const {
  of_readings([&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
    sum_up(coefficients, [&](const Block& block, std::size_t first, double* sums) {
      each_ray(block, [&](std::size_t r, const Fours& fours) {
        add_squares<K>(block, fours, &weights[(first + r) * K], sums);
      });
    });
  });
}

std::unique_ptr<RaySystem> make_ray_system(std::vector<DesignRay> rays, Readings readings,
                                           const RayWalk& walk) {
  return std::visit(
      [&]<class Reader>(std::vector<Reader>& readers) -> std::unique_ptr<RaySystem> {
        return std::make_unique<RaySystemOf<Reader::count>>(
            std::move(rays),
            [all = std::move(readers)](std::size_t i, const RayState& end) { return all[i](end); },
            walk);
      },
      readings);
}

}  // namespace flatspeckle::grin::design
