#include "grin/design/ray_system.h"

#include <algorithm>
#include <atomic>
#include <utility>

#include "core/run/parallel.h"

namespace flatspeckle::grin::design {

namespace {

/// Rays and one kind of reading; a visit chooses the field, once for each pass over all rays.
template <class Reader>
class RaySystemOf : public RaySystem {
 public:
  RaySystemOf(std::vector<DesignRay> rays, std::vector<Reader> readers, const RayWalk& walk)
      : rays_(std::move(rays)), readers_(std::move(readers)), walk_(walk), ends_(rays_.size()) {}

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

 private:
  static constexpr int K = Reader::count;

  template <class F>
  std::optional<std::vector<double>> trace_in(const F& field, const RayWalk& walk) {
    std::vector<double> readings(K * rays());
    std::atomic<bool> lost = false;
    each_block([&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end && !lost; ++i) {
        ends_[i] = follow<Pefrl>(field, rays_[i], walk);
        const auto values = readers_[i](ends_[i].state).values;
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
        pull_back<Pefrl>(field, rays_[i], walk_, ends_[i], readers_[i](ends_[i].state).by, sums);
        RayRows::Block& block = rows.block(b);
        sums.take([&](std::size_t number, const std::array<double, K>& derivatives) {
          block.index.push_back(static_cast<std::uint32_t>(number));
          for (const double d : derivatives) block.values.push_back(static_cast<float>(d));
        });
        block.end.push_back(block.index.size());
      }
    });
    return rows;
  }

  template <class Body>
  void each_block(const Body& body) const {
    constexpr std::size_t size = RayRows::block_size;
    parallel_for((rays() + size - 1) / size,
                 [&](std::size_t b) { body(b, b * size, std::min((b + 1) * size, rays())); });
  }

  std::vector<DesignRay> rays_;
  std::vector<Reader> readers_;
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
        return std::make_unique<RaySystemOf<Reader>>(std::move(rays), std::move(readers), walk);
      },
      readings);
}

}  // namespace flatspeckle::grin::design
