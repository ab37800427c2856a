#include "mc/estimators/covariance_estimator.h"

#include "mc/estimators/path_ends.h"
#include "mc/estimators/path_job.h"
#include "mc/estimators/single_scattering.h"

namespace flatspeckle::mc {

namespace {

/// Whether channels are every light in every view, [light][view].
bool is_grid(const std::vector<Channel>& channels, std::size_t lights, std::size_t views) {
  if (channels.size() != lights * views) return false;
  for (std::size_t c = 0; c < channels.size(); ++c)
    if (channels[c].light != c / views || channels[c].view != c % views) return false;
  return true;
}

/// The field f of every channel (C14), for an accumulator.
template <typename Scattering, bool reversed, bool phases>
class PathFields {
  using Direction = typename Scattering::Direction;

 public:
  PathFields(const Scene& scene, const Scattering& scattering, Accumulator& accumulator)
      : scattering_(scattering),
        channels_(scene.request.channels),
        accumulator_(accumulator),
        ends_(scene, [](std::size_t ends) { return std::vector<Complex>(ends); }),
        is_grid_(is_grid(channels_, ends_.lights.size(), ends_.views.size())),
        field_(channels_.size()) {}

  /// B = 1 at x.
  void single(Vec2 x, double weight) {
    ends_.lights.attenuate(x, ends_.light_last);
    ends_.views.attenuate(x, ends_.view_last);
    is_grid_ ? find_rows(local(scattering_, x)) : find_listed(local(scattering_, x));
    accumulator_.add(weight, field_);
  }

  void multiple(const Path<Direction>& path) {
    ends_.find(path, [this](auto& ends, Vec2 x, const Direction& arrival, auto& out) {
      ends.at(x, arrival, scattering_, out);
    });
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] = product(ends_.light_first[i], ends_.view_last[v]);
      if constexpr (reversed) field_[c] += product(ends_.light_last[i], ends_.view_first[v]);
    }
    accumulator_.add(path.weight, field_);
  }

 private:
  /// Of single scattering: each light into all views, a loop of vectors.
  template <typename Local>
  void find_rows(const Local& scattering) {
    const auto& view = ends_.view_last;
    for (std::size_t i = 0; i < ends_.lights.size(); ++i) {
      const std::span<Complex> row(&field_[i * view.size()], view.size());
      for (std::size_t v = 0; v < row.size(); ++v) row[v] = product(ends_.light_last[i], view[v]);
      scattering.towards(-ends_.lights.direction(i), ends_.views.directions(), row);
    }
  }
  template <typename Local>
  void find_listed(const Local& scattering) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const auto [i, v] = channels_[c];
      field_[c] =
          product(product(ends_.light_last[i], ends_.view_last[v]),
                  scattering.amplitude(-ends_.lights.direction(i), ends_.views.direction(v)));
    }
  }

  const Scattering& scattering_;
  const std::vector<Channel>& channels_;
  Accumulator& accumulator_;
  PathEnds<std::vector<Complex>, reversed, phases> ends_;  ///< A e of every end
  bool is_grid_;                                           ///< rows of views, a light each
  std::vector<Complex> field_;                             ///< per channel
};

struct CovarianceKind {
  using Sums = Accumulator&;

  NoTally tally(const Scene&) const { return {}; }

  template <bool reversed, bool phases, typename Scattering>
  auto scorer(const Scene& scene, const Scattering& scattering, Accumulator& accumulator) const {
    return PathFields<Scattering, reversed, phases>(scene, scattering, accumulator);
  }

  template <typename Scattering>
  std::vector<Complex> single(const Scene& scene, const Scattering& scattering) const {
    return single_scattering(scene, scattering);
  }
};

template <typename Entries>
auto into(const CovarianceRequest& request, const PathBatches& batches) {
  return [=](std::uint64_t number, std::span<Complex> sums) {
    Entries entries(request, sums);
    batches(number, entries);
    entries.finish();
  };
}

}  // namespace

PathBatches path_batches(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  return walks(CovarianceKind(), scene, plan, seed);
}

FieldJob covariance_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  const auto batches = path_batches(scene, plan, seed);
  const auto single = unsampled(CovarianceKind(), scene, plan);
  if (plan.rank_k)
    return path_job(scene, plan, 1, single, into<RankKAccumulator>(scene.request, batches)).field;
  return path_job(scene, plan, 1, single, into<EntryAccumulator>(scene.request, batches)).field;
}

}  // namespace flatspeckle::mc
