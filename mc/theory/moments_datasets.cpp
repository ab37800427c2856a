#include "mc/theory/moments_datasets.h"

#include <algorithm>
#include <cmath>

#include "core/result/result_group.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::mc {

const DatasetTable mean_table{
    "mean field",
    {{"mean_field", Data::complex_estimate, "LIGHT VIEW", "FIELD", "mean scattered field"}}};

const DatasetTable intensity_table{
    "intensity",
    {{"intensity", Data::estimate, "LIGHT VIEW", "COVARIANCE", "variance of the field"},
     {"gradient", Data::estimate, "parameter LIGHT VIEW", "",
      "derivative of the variance of the field"}}};

const DatasetTable pairs_table{
    "pairs",
    {{"covariance", Data::complex_estimate, "pair", "COVARIANCE", "covariance of the pair"},
     {"gradient", Data::complex_estimate, "parameter pair", "",
      "derivative of the covariance of the pair"}}};

const DatasetTable full_table{
    "full",
    {{"covariance", Data::complex_estimate, "LIGHT VIEW LIGHT_2 VIEW_2", "COVARIANCE",
      "covariance of the fields"},
     {"gradient", Data::complex_estimate, "parameter LIGHT VIEW LIGHT_2 VIEW_2", "",
      "derivative of the covariance of the fields"}}};

const DatasetTable moves_table{
    .name = "moves",
    .rows = {{"covariance", Data::complex_estimate, "MOVES VIEW", "COVARIANCE",
              "covariance of reference and moved field"},
             {"reference_intensity", Data::estimate, "VIEW", "COVARIANCE",
              "variance of the reference field"},
             {"tilted_intensity", Data::estimate, "tilt VIEW", "COVARIANCE",
              "variance of the moved field"},
             {"moved_intensity", Data::estimate, "MOVES VIEW", "COVARIANCE",
              "variance of the moved field"},
             {"field_correlation", Data::estimate, "MOVES", "1",
              "field correlation C_E, averaged over the views on one side: transmitted, if there are "
              "any"},
             {"memory_effect_range", Data::estimate, "", "1",
              "q L at C_I = 1/2 with matched views, L the depth"},
             {"memory_effect_angle", Data::estimate, "", "rad",
              "rotation of the light at C_I = 1/2 with matched views"},
             {"beam_angle", Data::estimate, "", "rad",
              "angle between the beams at C_I = 1/2 with matched views, if it is not that of the "
              "rotation"},
             {"tilt_range", Data::estimate, "", "1",
              "q L at C_I = 1/2 with fixed views, L the depth"},
             {"shift_range", Data::estimate, "", "SHIFT_RANGE",
              "shift at C_I = 1/2 with fixed light; for far views, times the depth L"},
             {"translation_range", Data::estimate, "", "length", "translation at C_I = 1/2"},
             {"matched_covariance", Data::complex_estimate, "tilt view_angle", "COVARIANCE",
              "covariance of reference and moved field"},
             {"matched_moved_intensity", Data::estimate, "tilt view_angle", "COVARIANCE",
              "variance of the moved field"},
             {"matched_correlation", Data::estimate, "tilt", "1",
              "field correlation C_E with matched views, averaged as in field_correlation"},
             {"reflected_field_correlation", Data::estimate, "MOVES", "1",
              "C_E of the reflected views, if there are transmitted views too"},
             {"reflected_memory_effect_range", Data::estimate, "", "1",
              "q L of the reflected views at C_I = 1/2 with matched views, L the depth"},
             {"reflected_memory_effect_angle", Data::estimate, "", "rad",
              "rotation of the light at C_I = 1/2 of the reflected views with matched views"},
             {"reflected_beam_angle", Data::estimate, "", "rad",
              "angle between the beams at C_I = 1/2 of the reflected views with matched views"},
             {"reflected_tilt_range", Data::estimate, "", "1",
              "q L of the reflected views at C_I = 1/2 with fixed views, L the depth"},
             {"reflected_shift_range", Data::estimate, "", "SHIFT_RANGE",
              "shift of the reflected views at C_I = 1/2 with fixed light, times the depth"},
             {"reflected_translation_range", Data::estimate, "", "length",
              "translation of the reflected views at C_I = 1/2"},
             {"reflected_matched_correlation", Data::estimate, "tilt", "1",
              "C_E of the reflected views with matched views"},
             {"diffusion_theory", Data::real, "tilt", "1",
              "C_E of matched views in diffusion theory of a slab"},
             {"single_scattering", Data::real, "tilt", "1",
              "C_E of matched views by single scattering in a slab without attenuation"},
             {"gradient", Data::complex_estimate, "parameter tilt VIEW", "",
              "derivative of the covariance of reference and tilted field"},
             {"reference_intensity_gradient", Data::estimate, "parameter VIEW", "",
              "derivative of the variance of the reference field"},
             {"tilted_intensity_gradient", Data::estimate, "parameter tilt VIEW", "",
              "derivative of the variance of the tilted field in the matched view"},
             {"field_correlation_gradient", Data::estimate, "parameter tilt", "",
              "derivative of the field correlation C_E"},
             {"memory_effect_range_gradient", Data::estimate, "parameter", "",
              "derivative of the range q L at C_I = 1/2; 0 if the range is censored"}},
    .attributes = {{"memory_effect_range", "censored", "uint64", censored_meaning},
                   {"memory_effect_angle", "censored", "uint64", censored_meaning},
                   {"reflected_memory_effect_angle", "censored", "uint64", censored_meaning},
                   {"beam_angle", "censored", "uint64", censored_meaning},
                   {"reflected_beam_angle", "censored", "uint64", censored_meaning},
                   {"tilt_range", "censored", "uint64", censored_meaning},
                   {"shift_range", "censored", "uint64", censored_meaning},
                   {"translation_range", "censored", "uint64", censored_meaning},
                   {"reflected_memory_effect_range", "censored", "uint64", censored_meaning},
                   {"reflected_tilt_range", "censored", "uint64", censored_meaning},
                   {"reflected_shift_range", "censored", "uint64", censored_meaning},
                   {"reflected_translation_range", "censored", "uint64", censored_meaning}},
    .roles = {{"MOVES", {"tilt", "tilt shift", "shift"}}, {"SHIFT_RANGE", {"1", "length"}}}};

namespace {

using Kind = CovarianceRequest::Kind;

/// Writes the mean field of every light and view. For requests with moves it writes only the mean
/// field of the reference, for pairs none.
void write_mean(const ResultGroup& out, const CovarianceRequest& request, const Estimate& mean) {
  if (mean.value.empty() || request.kind == Kind::pairs) return;
  if (!request.has_reference()) return out.put("mean_field", mean);
  Estimate reference;
  for (std::size_t v = 0; v < request.reference_views; ++v)
    append(reference, part(mean, request.entries[request.reference_intensity(v)].a, 1));
  out.put("mean_field", reference);
}

/// Writes the results of memory_effect, tilt_shift and translation requests.
class MovesWriter {
 public:
  MovesWriter(const ResultGroup& out, const Scene& scene)
      : out_(out), scene_(scene), request_(scene.request) {}

  void entries(const Estimate& covariance) const {
    const bool tilts = request_.kind == Kind::memory_effect,
               map = request_.kind == Kind::tilt_shift;
    const std::size_t matched = map && far() ? request_.tilts.size() : 0,
                      moves = request_.moves - matched;
    out_.put("reference_intensity",
             part(covariance, request_.reference_intensity(0), request_.reference_views));
    moved(covariance, "covariance", tilts ? "tilted_intensity" : "moved_intensity", 0, moves);
    if (matched) moved(covariance, "matched_covariance", "matched_moved_intensity", moves, matched);
  }

  /// Writes the correlations and ranges of a group of views. prefix: beginning of the names of the
  /// datasets.
  WrittenMoves correlation(const Correlations& found, const std::string& prefix) {
    prefix_ = prefix;
    ranges_.clear();
    request_.kind == Kind::tilt_shift ? map(found) : curve(found);
    return {found.moves, ranges_};
  }

  /// Writes theoretical C_E for plane waves transmitted into matched views, if the request contains
  /// them and the medium is homogeneous: single scattering and diffusion theory.
  void theory(const std::vector<std::size_t>& group) const {
    if (request_.kind != Kind::tilt_shift || !far() || !request_.lights.all(Light::Kind::plane) ||
        scene_.profile)
      return;
    std::vector<View> views;
    for (const std::size_t v : group) views.push_back(request_.views[v]);
    if (std::cos(views.front().angle) <= 0) return;
    out_.put("diffusion_theory", column(request_.tilt_q, [&](double q) {
               return diffusion_field_correlation(scene_, q);
             }));
    out_.put("single_scattering", column(request_.tilt_q, [&](double q) {
               return single_scattering_correlation(request_.lights.front(), views,
                                                    scene_.domain.depth, q, request_.tilt_azimuth);
             }));
  }

 private:
  bool far() const { return !request_.views.front().near; }

  /// Writes the only correlation curve of a request and its range. The curve is over tilts with
  /// matched views, or over translations.
  void curve(const Correlations& found) {
    const bool tilts = request_.kind == Kind::memory_effect;
    const RangeEstimate& only = found.ranges.front();
    out_.put(prefix_ + "field_correlation", found.moves);
    tilts ? range("memory_effect_range", only, scene_.domain.depth)
          : range("translation_range", only, 1);
    ranges_.back().few_steps = few_steps(tilts ? request_.tilt_q : request_.shifts, only.range);
    if (tilts) angle(only);
  }

  /// Writes the rotation of the light at the range and, if it differs, the angle between the beams.
  void angle(const RangeEstimate& range_in_q) {
    const RangeTilt tilt = tilt_of_range(request_, scene_.outside_k(), range_in_q.range.value);
    const auto write_angle = [&](const std::string& name, double value, double per_q) {
      RangeEstimate estimate = range_in_q;
      estimate.range.value = value;
      estimate.error *= per_q;
      range(name, estimate, 1);
      ranges_.back().is_angle = true;
    };
    write_angle("memory_effect_angle", tilt.rotation, tilt.rotation_per_q);
    if (is_tilted_aside(request_)) write_angle("beam_angle", tilt.between, tilt.between_per_q);
  }

  void map(const Correlations& found) {
    const std::size_t tilts = request_.tilts.size(), map = tilts * request_.shifts.size();
    const double depth = scene_.domain.depth;
    out_.put(prefix_ + "field_correlation", part(found.moves, 0, map));
    range("tilt_range", found.ranges[0], depth);
    range("shift_range", found.ranges[1], far() ? depth : 1);
    if (!far()) return;
    out_.put(prefix_ + "matched_correlation", part(found.moves, map, tilts));
    range("memory_effect_range", found.ranges[2], depth);
  }

  /// Writes the covariances of reference and moved field, and the intensities of the moved field,
  /// for `moves` moves from number `first` on.
  void moved(const Estimate& all, const std::string& covariance, const std::string& intensity,
             std::size_t first, std::size_t moves) const {
    const std::size_t count = moves * request_.reference_views;
    out_.put(covariance, part(all, request_.tilted_entry(first, 0), count));
    out_.put(intensity, part(all, request_.tilted_intensity(first, 0), count));
  }

  void range(const std::string& name, RangeEstimate estimate, double scale) {
    const std::string path = prefix_ + name;
    estimate.range.value *= scale;
    estimate.error *= scale;
    out_.put(path, {{estimate.range.value}, {estimate.error}, {estimate.rare}});
    out_.attribute(path, "censored", static_cast<std::uint64_t>(estimate.range.censored));
    ranges_.push_back({out_.row(path).long_name, estimate});
  }

  const ResultGroup& out_;
  const Scene& scene_;
  const CovarianceRequest& request_;
  std::string prefix_;
  std::vector<WrittenRange> ranges_;
};

std::vector<Axis> moves_of(const CovarianceRequest& request) {
  if (request.kind == Kind::tilt_shift) return {"tilt", "shift"};
  return {request.kind == Kind::translation ? "shift" : "tilt"};
}

}  // namespace

const DatasetTable& request_table(Kind kind) {
  switch (kind) {
    case Kind::intensity:
      return intensity_table;
    case Kind::pairs:
      return pairs_table;
    case Kind::full:
      return full_table;
    default:
      return moves_table;
  }
}

Estimate unpack_full(const CovarianceRequest& request, const Estimate& triangle) {
  const std::size_t n = request.channels.size();
  Estimate full{std::vector<Complex>(n * n), std::vector<double>(n * n),
                std::vector<std::uint64_t>(triangle.rare.empty() ? 0 : n * n)};
  std::size_t entry = 0;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++entry) {
      full.value[b * n + a] = std::conj(triangle.value[entry]);
      full.value[a * n + b] = triangle.value[entry];
      full.error[a * n + b] = full.error[b * n + a] = triangle.error[entry];
      if (!full.rare.empty()) full.rare[a * n + b] = full.rare[b * n + a] = triangle.rare[entry];
    }
  }
  return full;
}

std::vector<WrittenMoves> write_moments(ResultFile& file, const std::string& group,
                                        const FieldJob& job, const Scene& scene,
                                        const GroupedSums& sums, const FieldMoments& moments) {
  const CovarianceRequest& request = scene.request;
  write_mean({file, mean_table, group}, request, moments.mean);
  const ResultGroup out(file, request_table(request.kind), group);
  if (request.kind == Kind::intensity) out.put("intensity", moments.covariance);
  if (request.kind == Kind::pairs) out.put("covariance", moments.covariance);
  if (request.kind == Kind::full) out.put("covariance", unpack_full(request, moments.covariance));
  if (!request.has_reference()) return {};
  file.bind("MOVES", moves_of(request));
  file.bind("SHIFT_RANGE", {request.views.front().near ? "length" : "1"});
  MovesWriter writer(out, scene);
  writer.entries(moments.covariance);
  const auto groups = view_groups(request);
  writer.theory(groups.front());
  std::vector<WrittenMoves> written;
  for (const auto& views : groups)
    written.push_back(writer.correlation(correlations(request, sums, job.covariance, views),
                                         written.empty() ? "" : "reflected_"));
  return written;
}

}  // namespace flatspeckle::mc
