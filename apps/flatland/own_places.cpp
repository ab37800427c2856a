#include "apps/flatland/own_places.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "apps/results/datasets.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/blas.h"
#include "core/result/result_group.h"
#include "flatland/request/request.h"
#include "flatland/scene/scene_datasets.h"
#include "flatland/scene/scene_density.h"
#include "mc/theory/allowance.h"
#include "mc/theory/moments_datasets.h"
#include "wave_solver/solutions/space_solution.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::apps {

const DatasetTable own_places_table{
    .name = "own places",
    .rows = {{"intensity_ratio", Data::real, "LIGHT VIEW", "1", "|far_field|^2 over mc/intensity"},
             {"forward", Data::count, "LIGHT VIEW", "1",
              "1: in the forward lobe of the coherent field; excluded from the statistics below"},
             {"mean_ratio", Data::estimate, "", "1", "mean of intensity_ratio; expected: 1"},
             {"ratio_contrast", Data::estimate, "", "1",
              "standard deviation of intensity_ratio over its mean; expected: 1"},
             {"independent_grains", Data::real, "", "1",
              "effective number of independent intensities: n^2 over the sum of |C|^2 / (I I') of "
              "n channels, by Monte Carlo"}}};

void add_places_key(Keys& keys, SceneSpec& spec) {
  keys.remove("placement");
  keys.add("placement", spec.placement,
           "Random placements: poisson, hard_disk (default for disks) or equilibrium; or a CSV "
           "file with columns x, z (without count): one placement, whose intensities are compared "
           "with Monte Carlo");
}

bool has_own_places(const SceneSpec& spec) {
  return spec.placement &&
         std::ranges::find(placement_words, *spec.placement) == placement_words.end();
}

namespace {

/// Largest number of channels (pairs of light and view). More would need gigabytes of memory for
/// their covariances, and are not needed to resolve the speckle grains.
constexpr std::size_t most_channels = 512;

Placement read_places(const std::string& path, const Scatterer& scatterer, bool in_space) {
  Placement placement = read_placement(path, scatterer, in_space);
  if (placement.empty()) throw InputError("placement", path, "must contain at least one scatterer");
  for (std::size_t row = 0; row < placement.size(); ++row)
    if (placement[row].scatterer != scatterer)
      throw InputError("placement", path,
                       "row " + std::to_string(row + 1) +
                           " has another radius or index than the keys; Monte Carlo requires equal "
                           "scatterers (solve accepts unequal ones)");
  return placement;
}

void require_in_box(const Placement& placement, const Domain& box, const std::string& path) {
  for (std::size_t row = 0; row < placement.size(); ++row) {
    const Vec at = placement[row].position;
    if (box.contains(at)) continue;
    throw InputError("placement", path,
                     "row " + std::to_string(row + 1) + ", (" + number_text(at.x) + ", " +
                         number_text(at.z) +
                         "), must lie inside the box |x| <= width / 2, 0 <= z <= depth" +
                         (box.height > 0 ? ", |y| <= height / 2" : ""));
  }
}

/// Throws InputError if a key gives the number or density of scatterers, because the table
/// determines it.
void refuse_numbers(const SceneSpec& spec) {
  if (const auto given = given_densities(spec); !given.empty())
    throw InputError("placement", *spec.placement,
                     "determines the number of scatterers: leave out " + join_texts(given, ", "));
}

void require_simple(const Scene& scene) {
  if (scene.profile || scene.index || scene.faces || !scene.medium.has_scatterers ||
      has_near_endpoints(scene.request) || scene.request.kind != CovarianceRequest::Kind::intensity)
    throw InputError(
        "placement: a table of positions requires a homogeneous box without medium_index, plane "
        "waves, far views and covariance = intensity");
}

/// Returns the request of the covariances of all pairs of channels, from which the number of
/// independent speckle grains follows.
CovarianceRequest all_pairs(const CovarianceRequest& request) {
  if (request.channels.size() > most_channels)
    throw InputError("view_angles", std::to_string(request.views.size()) + " angles",
                     "with a table of positions, lights and views must make at most " +
                         std::to_string(most_channels) + " pairs");
  return full_request(request.lights, request.views);
}

Estimate intensities_of(const Estimate& triangle, std::size_t channels) {
  Estimate found;
  for (std::size_t c = 0; c < channels; ++c) append(found, part(triangle, triangle_entry(c, c), 1));
  return found;
}

/// Returns the batches of the job, with the relative error of the intensities as the error that is
/// compared with the target.
BatchJob steered(FieldJob job, std::size_t channels) {
  job.batches.relative_error = relative_error_of(
      [covariance = job.covariance, channels](double samples, std::span<const Complex> sums) {
        return diagonal(covariance(samples, sums), channels);
      });
  return job.batches;
}

/// Statistics of the speckle pattern of the given placement.
struct Pattern {
  /// For each channel, the intensity divided by the mean intensity of Monte Carlo.
  std::vector<double> ratio;
  /// 1 for channels in the forward lobe of the coherent field, which the statistics leave out.
  std::vector<std::uint64_t> forward;
  double mean = 0, contrast = 0, grains = 0, mean_error = 0, contrast_error = 0;
};

/// Returns the number of independent speckle grains in the pattern. It follows from the covariances
/// |C|^2 of intensities, where C is the covariance of the Gaussian fields (Siegert relation), minus
/// the bias by noise.
double independent_grains(const Estimate& triangle, const Pattern& pattern) {
  const std::size_t channels = pattern.ratio.size();
  double sum = 0, used = 0;
  for (std::size_t a = 0, e = 0; a < channels; ++a)
    for (std::size_t b = 0; b <= a; ++b, ++e) {
      if (pattern.forward[a] || pattern.forward[b]) continue;
      const double product =
          triangle.value[triangle_entry(a, a)].real() * triangle.value[triangle_entry(b, b)].real();
      const double noise = a == b ? 0 : triangle.error[e] * triangle.error[e];
      sum += (a == b ? 1 : 2) * (std::norm(triangle.value[e]) - noise) / product;
      used += a == b ? 1 : 0;
    }
  return std::clamp(used * used / sum, 1.0, used);
}

/// Computes mean and contrast of the ratios, and their errors. For N independent grains with
/// exponentially distributed intensities, mean and contrast each have the variance 1/N.
void add_statistics(Pattern& pattern, const Estimate& triangle) {
  double used = 0, squares = 0, mc_error = 0;
  for (std::size_t c = 0; c < pattern.ratio.size(); ++c) {
    if (pattern.forward[c]) continue;
    pattern.mean += pattern.ratio[c];
    squares += pattern.ratio[c] * pattern.ratio[c];
    mc_error += triangle.error[triangle_entry(c, c)] / triangle.value[triangle_entry(c, c)].real();
    used += 1;
  }
  pattern.mean /= used;
  pattern.grains = independent_grains(triangle, pattern);
  const double variance = squares / used - pattern.mean * pattern.mean,
               unbiased = pattern.grains > 1 ? pattern.grains / (pattern.grains - 1) : 1;
  pattern.contrast = std::sqrt(std::max(0.0, variance * unbiased)) / pattern.mean;
  pattern.contrast_error = 1 / std::sqrt(pattern.grains);
  pattern.mean_error = std::hypot(pattern.contrast_error, mc_error / used);
}

Pattern pattern_of(const Scene& scene, const std::vector<Complex>& fields,
                   const Estimate& triangle) {
  Pattern pattern;
  for (std::size_t c = 0; c < fields.size(); ++c) {
    pattern.ratio.push_back(std::norm(fields[c]) / triangle.value[triangle_entry(c, c)].real());
    pattern.forward.push_back(mc::in_forward_lobe(scene, scene.request.channels[c]) ? 1 : 0);
  }
  add_statistics(pattern, triangle);
  return pattern;
}

void print(const Pattern& pattern, const Scene& scene, std::size_t scatterers) {
  const auto left_out = std::ranges::count(pattern.forward, 1U);
  std::printf(
      "%zu scatterers, one speckle pattern: %zu intensities of about %.0f independent grains\n"
      "|u|^2 over the mean intensity of Monte Carlo: mean %.3f +- %.2g, contrast %.3f +- %.2g\n"
      "expected for a speckle pattern: 1 and 1; effects neglected by Monte Carlo: %.1f %%\n",
      scatterers, pattern.ratio.size() - static_cast<std::size_t>(left_out), pattern.grains,
      pattern.mean, pattern.mean_error, pattern.contrast, pattern.contrast_error,
      100 * mc::Allowance(scene).total());
  if (left_out > 0)
    std::printf("%td views in the forward lobe of the coherent field are excluded\n", left_out);
}

void write(ResultFile& file, const Pattern& pattern, const Scene& scene) {
  const ResultGroup root(file, own_places_table);
  root.put("intensity_ratio", std::span<const double>(pattern.ratio));
  root.put("forward", std::span<const std::uint64_t>(pattern.forward));
  root.put("mean_ratio", pattern.mean, pattern.mean_error);
  root.put("ratio_contrast", pattern.contrast, pattern.contrast_error);
  root.put("independent_grains", pattern.grains);
  ResultGroup(file, validate_table).attribute("bias_allowance", mc::Allowance(scene).total());
}

/// Returns the positions of the scatterers as text, for the identity of the run.
std::string places_text(const Placement& placement) {
  std::string text;
  for (const auto& [x, scatterer] : placement)
    text += "place " + number_text(x.x) + ' ' + number_text(x.z) + '\n';
  return text;
}

}  // namespace

OwnPlaces::OwnPlaces(const Keys& keys, SceneSpec& spec, const MethodSettings& methods)
    : tolerance_(keys.read(methods.wave_tolerance)) {
  if (!std::filesystem::exists(*spec.placement))
    throw InputError("placement", *spec.placement,
                     "must be one of " + join_texts(placement_words, " ") +
                         ", or the name of a CSV file (no such file)");
  if (spec.domain != "box")
    throw InputError("domain", spec.domain, "must be box for a table of positions (placement)");
  refuse_numbers(spec);
  const std::optional<std::string> path = keys.read(spec.placement);
  placement_ = read_places(*path, make_scatterer(keys, spec), spec.dimension == 3);
  spec.placement.reset();  // for Monte Carlo, the scene describes random placements
  spec.count = static_cast<std::int64_t>(placement_.size());
  scene_ = with_dimension(make_scene(keys, spec), spec);
  spec.placement = path;  // restores the given values of the keys
  spec.count.reset();
  require_simple(scene_);
  require_in_box(placement_, scene_.domain, *path);
  refuse_absurd(methods, Neglected(scene_));
  scene_.request = all_pairs(scene_.request);
  if (std::ranges::all_of(scene_.request.channels, [&](const Channel& channel) {
        return mc::in_forward_lobe(scene_, channel);
      }))
    throw InputError("view_angles", number_text(spec.view_angles),
                     "all lie in the forward lobe of the coherent field: give many other angles, "
                     "such as 0.3:2.8:200");
}

int OwnPlaces::compare(Session& session, mc::ReversedPaths reversed, const StopRule& stop) const {
  blas_single_thread();  // called here so that missing memory is reported before the slow work
  const CovarianceRequest& request = scene_.request;
  const wave::SolveOptions options{.tolerance = tolerance_, .sensors = {}};
  if (scene_.medium.dimension == 3) {
    const auto solution = wave::solve_in_space(placement_, scene_.k, request.lights, options);
    return compare(
        session, reversed, stop, solution.method(), solution.fields(request.views),
        [&](ResultFile& file) { wave::write_solution(file, solution, request.views, {}); });
  }
  const auto solution = wave::solve(placement_, scene_.k, request.lights.angles(), options);
  return compare(session, reversed, stop, solution.method(), solution.fields(request.views),
                 [&](ResultFile& file) {
                   wave::write_solution(file, solution, column(request.views, &View::angle), {});
                 });
}

int OwnPlaces::compare(Session& session, mc::ReversedPaths reversed, const StopRule& stop,
                       const std::string& method, const std::vector<Complex>& fields,
                       const std::function<void(ResultFile&)>& write_solution) const {
  const Estimation mc = mc_estimation(scene_, reversed, session.seed());
  return session.run(
      mc.plan + "\nwave: " + method, {{"mc", "mc", steered(mc.job, fields.size()), stop}},
      inputs_text(scene_) + places_text(placement_), [&](ResultFile& file) {
        const Estimate triangle = field_moments(mc.job, session.sums("mc")).covariance;
        const Pattern pattern = pattern_of(scene_, fields, triangle);
        print(pattern, scene_, placement_.size());
        write_medium(file, scene_);
        write_solution(file);
        bind_units(file, scene_);
        ResultGroup(file, mc::intensity_table, "mc")
            .put("intensity", intensities_of(triangle, fields.size()));
        write(file, pattern, scene_);
      });
}

}  // namespace flatspeckle::apps
