#include "grin/design/system/ray_system.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <utility>

#include "core/run/interrupt.h"
#include "core/run/parallel.h"

namespace flatspeckle::grin::design {

namespace {

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

  /// Of shares of the rays in turn, then of the shares: the same for any number of threads.
  template <class F>
  std::vector<double> gradient_in(const F& field, std::span<const double> weights) const {
    constexpr std::size_t shares = 16;
    const CoefficientShape shape = shape_of(field);
    std::vector<std::vector<double>> of_share(shares);
    parallel_for(shares, [&](std::size_t s) {
      CoefficientSums<1> sums(shape);
      for (std::size_t i = s * rays() / shares; i < (s + 1) * rays() / shares; ++i) {
        stop_if_interrupted();
        pull_back<Pefrl>(field, rays_[i], walk_, ends_[i], weighted(i, &weights[K * i]), sums);
      }
      of_share[s].assign(shape.size(), 0.0);
      sums.take(
          [&](std::size_t number, const std::array<double, 1>& d) { of_share[s][number] = d[0]; });
    });
    std::vector<double> gradient(shape.size(), 0.0);
    for (const auto& share : of_share)
      for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] += share[i];
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
