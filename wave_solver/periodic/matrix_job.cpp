#include "wave_solver/periodic/matrix_job.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/error.h"
#include "core/numbers/random.h"
#include "flatland/scene/periodic_placement.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/periodic/shaped_light.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t correlations = 3;

// Places of the sums of a batch. Correlations are [kind][shift][numerator, both denominators].
struct MatrixSums {
  MatrixSums(const std::vector<CellChannel>& channels, const MatrixSettings& settings)
      : n(channels.size()),
        bins(settings.eigenvalue_bins),
        shifts(settings.shifts + 1),
        segments{n} {
    for (const std::int64_t number : settings.segments)
      segments.push_back(static_cast<std::size_t>(number));
    for (const double fraction : settings.conjugated_fraction)
      recorded.push_back(recorded_channels(fraction, n));
    for (std::size_t a = 0; a < n; ++a) {
      if (std::abs(channels[a].sine) > settings.numerical_aperture) continue;
      if (kept++ == 0) first_kept = a;
    }
  }

  static constexpr std::size_t g = 0, g_squared = 1, largest = 2, power_error = 3,
                               reciprocity_error = 4, unit_cell_error = 5, unit_cell_limit = 6,
                               reflected = 7;
  std::size_t transmitted() const { return reflected + n; }
  std::size_t squares() const { return transmitted() + n; }
  std::size_t eigenvalues() const { return squares() + n; }
  std::size_t filtered() const { return eigenvalues() + bins; }
  std::size_t correlation(std::size_t kind, std::size_t shift) const {
    return filtered() + bins + 3 * (kind * shifts + shift);
  }
  std::size_t focused(std::size_t i) const { return correlation(correlations, 0) + 2 * i; }
  std::size_t conjugated(std::size_t i) const { return focused(segments.size()) + 2 * i; }
  std::size_t size() const { return conjugated(recorded.size()); }

  std::size_t n, bins, shifts;
  std::vector<std::size_t> segments;     // numbers of segments: the first is n
  std::vector<std::size_t> recorded;     // numbers of channels that are recorded and conjugated
  std::size_t first_kept = 0, kept = 0;  // channels within the numerical aperture
};

// Adds numerator and denominators of the correlation between the outgoing waves `first` and
// `second`, whose channels are shifted by `shift`. The channel `direct` contains the mean field and
// is omitted.
void add_correlation(std::span<const Complex> first, std::span<const Complex> second,
                     std::size_t shift, std::size_t direct, Complex* sums) {
  for (std::size_t b = 0; b + shift < first.size(); ++b) {
    if (b == direct) continue;
    sums[0] += product_with_conjugate(first[b], second[b + shift]);
    sums[1] += std::norm(first[b]);
    sums[2] += std::norm(second[b + shift]);
  }
}

void add_correlations(const MatrixSums& places, const std::vector<Complex>& t,
                      const std::vector<Complex>& open, std::span<Complex> sums) {
  const std::size_t n = places.n, normal = n / 2;
  const auto column = [&](std::size_t a) { return std::span(t).subspan(a * n, n); };
  const auto sent = [&](std::size_t shift) {  // outgoing wave of the shifted open channel
    std::vector<Complex> wave(n), out(n);
    std::copy(open.begin(), open.end() - static_cast<std::ptrdiff_t>(shift),
              wave.begin() + static_cast<std::ptrdiff_t>(shift));
    multiply(CblasNoTrans, CblasNoTrans, n, 1, n, 1, t.data(), n, wave.data(), n, 0, out.data(), n);
    return out;
  };
  const auto unshifted = sent(0);
  for (std::size_t shift = 0; shift < places.shifts; ++shift) {
    for (std::size_t a = 0; a + shift < n; ++a)
      add_correlation(column(a), column(a + shift), shift, a, &sums[places.correlation(0, shift)]);
    add_correlation(column(normal), column(normal + shift), shift, normal,
                    &sums[places.correlation(1, shift)]);
    add_correlation(unshifted, sent(shift), shift, n, &sums[places.correlation(2, shift)]);
  }
}

void count_eigenvalues(const std::vector<double>& eigenvalues, std::span<Complex> bins) {
  for (const double value : eigenvalues) {
    const auto bin = static_cast<std::size_t>(value * static_cast<double>(bins.size()));
    bins[std::min(bin, bins.size() - 1)] += 1;
  }
}

// Returns the part of t between the middle `kept` channels of both sides.
std::vector<Complex> middle_part(const std::vector<Complex>& t, std::size_t n, std::size_t first,
                                 std::size_t kept) {
  std::vector<Complex> part;
  for (std::size_t a = first; a < first + kept; ++a) {
    const auto column = t.begin() + static_cast<std::ptrdiff_t>(a * n + first);
    part.insert(part.end(), column, column + static_cast<std::ptrdiff_t>(kept));
  }
  return part;
}

// to_back: phase of each channel from z = 0 to the back of the slab, the phase origin of t.
void add_matrix(const MatrixSums& places, const ScatteringMatrix& found,
                const std::vector<Complex>& to_back, std::span<Complex> sums) {
  const std::size_t n = places.n;
  auto t = found.quarter(false, true);
  const auto r = found.quarter(false, false);
  for (std::size_t i = 0; i < t.size(); ++i) t[i] *= to_back[i % n];
  double g = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double transmitted = 0;
    for (std::size_t b = 0; b < n; ++b) {
      transmitted += std::norm(t[b + n * a]);
      sums[MatrixSums::reflected + a] += std::norm(r[b + n * a]);
    }
    sums[places.transmitted() + a] += transmitted;
    sums[places.squares() + a] += transmitted * transmitted;
    g += transmitted;
  }
  sums[MatrixSums::g] += g;
  sums[MatrixSums::g_squared] += g * g;
  for (std::size_t i = 0; i < places.segments.size(); ++i)
    add_focus(t, n, places.segments[i], sums.subspan(places.focused(i)).first<2>());
  for (std::size_t i = 0; i < places.recorded.size(); ++i)
    add_conjugation(t, n, places.recorded[i], sums.subspan(places.conjugated(i)).first<2>());
  sums[MatrixSums::power_error] += found.power.off;
  sums[MatrixSums::reciprocity_error] += found.reciprocity.off;
  sums[MatrixSums::unit_cell_error] += found.unit_cell.off;
  sums[MatrixSums::unit_cell_limit] += found.unit_cell.limit;
  const auto [eigenvalues, waves] = eigenchannels(t, n);
  sums[MatrixSums::largest] += eigenvalues.front();
  count_eigenvalues(eigenvalues, sums.subspan(places.eigenvalues(), places.bins));
  if (places.kept < n)
    count_eigenvalues(
        eigenchannels(middle_part(t, n, places.first_kept, places.kept), places.kept).eigenvalues,
        sums.subspan(places.filtered(), places.bins));
  add_correlations(places, t, waves.front(), sums);
}

}  // namespace

Eigenchannels eigenchannels(std::vector<Complex> t, std::size_t n) {
  const auto size = static_cast<lapack_int>(n);
  std::vector<double> singular(n), rest(n);
  std::vector<Complex> left(1), right(n * n);
  LAPACKE_zgesvd(LAPACK_COL_MAJOR, 'N', 'A', size, size, t.data(), size, singular.data(),
                 left.data(), 1, right.data(), size, rest.data());
  Eigenchannels found;
  for (const double value : singular) found.eigenvalues.push_back(value * value);
  for (std::size_t m = 0; m < n; ++m) {
    auto& wave = found.waves.emplace_back();
    for (std::size_t a = 0; a < n; ++a) wave.push_back(std::conj(right[a * n + m]));
  }
  return found;
}

MatrixJob matrix_job(const Scene& scene, const MatrixSettings& settings, std::uint64_t seed) {
  blas_single_thread();  // throws before the run if BLAS lacks memory
  const Period period{scene.domain.width, settings.phase};
  MatrixJob job{{}, channels_of(scene.k, period), settings};
  const std::size_t n = job.channels.size();
  if (n < 2) throw InputError("width", scene.domain.width, "has fewer than two channels");
  if (settings.shifts >= n / 2)
    throw InputError("shifts", settings.shifts,
                     "must be less than half the number of channels, " + std::to_string(n));
  const MatrixSums places(job.channels, settings);
  if (places.kept == 0)
    throw InputError("numerical_aperture", settings.numerical_aperture,
                     "must be larger: it contains no channel of this width");
  for (const std::int64_t number : settings.segments)
    if (static_cast<std::size_t>(number) > n)
      throw InputError("segments", number,
                       "must not exceed the number of channels, " + std::to_string(n));
  const Domain& box = scene.domain;
  const double radius = scene.scatterer.disk_radius();
  const Rectangle region{{-box.width / 2 - radius, -radius},
                         {box.width / 2 + radius, box.depth + radius}};
  const CellImages images =
      cell_images(scene.k, period, region, image_tolerance(settings.options.tolerance));
  std::vector<Complex> to_back;
  for (const CellChannel& channel : job.channels)
    to_back.push_back(std::polar(1.0, scene.k * box.depth * channel.cosine));
  job.batches.size = places.size();
  job.batches.trusted_batches = 8;
  job.batches.run = [=](std::uint64_t number, std::span<Complex> sums) {
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), number);
    const auto placement = draw_periodic_placement(scene, random);
    auto found = scattering_matrix_in_region(placement, scene.k, images, settings.options);
    if (number == 0) compare_unit_cells(found, placement, scene.k, period, settings.options);
    add_matrix(places, found, to_back, sums);
  };
  job.batches.relative_error = [](const GroupedSums& sums) {
    return relative_error(jackknife(sums, [](double samples, std::span<const Complex> all) {
      return std::vector{all[MatrixSums::g] / samples};
    }));
  };
  return job;
}

MatrixStatistics matrix_statistics(const MatrixJob& job, const GroupedSums& sums) {
  const std::size_t n = job.channels.size();
  const MatrixSums places(job.channels, job.settings);
  using Values = std::vector<Complex>;
  using Sums = std::span<const Complex>;
  const auto variance = [](double samples, Complex sum, Complex squares) {
    return samples < 2 ? Complex() : (squares - sum * sum / samples) / (samples - 1);
  };
  const auto estimate = [&](const Estimator& of) { return jackknife(sums, of); };
  const auto estimate_of_variance = [&](const Estimator& of) {
    Estimate found = estimate(of);
    // without one of two samples no variance is left
    if (sums.total_samples() < 3) found.error.assign(1, std::numeric_limits<double>::infinity());
    return found;
  };
  const auto means = [&](std::size_t first, std::size_t count) {
    return estimate(
        [=](double samples, Sums s) { return sample_mean(samples, s.subspan(first, count)); });
  };
  const auto correlation = [&](std::size_t kind) {
    return estimate([=](double, Sums s) {
      Values values;
      for (std::size_t shift = 0; shift < places.shifts; ++shift) {
        const Complex* const c = &s[places.correlation(kind, shift)];
        values.emplace_back(std::abs(c[0]) / std::sqrt(c[1].real() * c[2].real()));
      }
      return values;
    });
  };
  const auto ratios = [&](std::size_t first, std::size_t count) {
    return estimate([=](double, Sums s) {
      Values values;
      for (std::size_t i = 0; i < count; ++i)
        values.push_back(s[first + 2 * i] / s[first + 2 * i + 1]);
      return values;
    });
  };
  MatrixStatistics found;
  found.transmittance = means(places.transmitted(), n);
  found.reflectance = means(MatrixSums::reflected, n);
  found.conductance = means(MatrixSums::g, 1);
  found.largest = means(MatrixSums::largest, 1);
  found.eigenvalues = means(places.eigenvalues(), places.bins);
  found.kept = places.kept;
  if (found.kept < n) found.filtered = means(places.filtered(), places.bins);
  found.conductance_variance = estimate_of_variance([=](double samples, Sums s) {
    return Values{variance(samples, s[MatrixSums::g], s[MatrixSums::g_squared])};
  });
  found.relative_variance = estimate_of_variance([=](double samples, Sums s) {
    const Complex mean = s[MatrixSums::g] / samples;
    return Values{variance(samples, s[MatrixSums::g], s[MatrixSums::g_squared]) / (mean * mean)};
  });
  found.channel_variance = estimate_of_variance([=](double samples, Sums s) {
    Complex sum = 0;
    for (std::size_t a = 0; a < n; ++a) {
      const Complex mean = s[places.transmitted() + a] / samples;
      sum += variance(samples, s[places.transmitted() + a], s[places.squares() + a]) /
             (mean * mean * static_cast<double>(n));
    }
    return Values{sum};
  });
  found.focus = ratios(places.focused(0), 1);
  found.segment_focus = ratios(places.focused(1), places.segments.size() - 1);
  found.conjugation = ratios(places.conjugated(0), places.recorded.size());
  found.tilt_correlation = correlation(0);
  found.normal_correlation = correlation(1);
  found.open_correlation = correlation(2);
  const auto transmittance = real_parts(found.transmittance.value);
  for (const std::size_t number : places.segments)
    found.focus_theory.push_back(expected_focus(transmittance, number));
  for (const std::size_t number : places.recorded) {
    found.recorded.push_back(static_cast<double>(number) / static_cast<double>(n));
    found.conjugation_theory.push_back(expected_conjugation(transmittance, number));
  }
  const auto total = sums.total();
  const double slack = 1e-12 + 300 * job.settings.options.tolerance, samples = sums.total_samples();
  found.power = {total[MatrixSums::power_error].real() / samples, slack};
  found.reciprocity = {total[MatrixSums::reciprocity_error].real() / samples, slack};
  found.unit_cell = {total[MatrixSums::unit_cell_error].real(),
                     total[MatrixSums::unit_cell_limit].real()};
  return found;
}

}  // namespace flatspeckle::wave
