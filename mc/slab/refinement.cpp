#include "mc/slab/refinement.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "core/result/result_group.h"

namespace flatspeckle::mc {

const DatasetTable numerical_table{
    .name = "numerical",
    .rows = {},
    .attributes = {{"", "errors", "text", "meaning of the errors, if they are not statistical"}}};

double Changes::error() const {
  // Estimated sum of all further changes, in units of the last change, if the changes hardly decay.
  constexpr double slowest = 3;
  constexpr double usual = 0.3;  // ratio of a change to the previous one
  if (!are_enough()) return slowest * last;
  const double left = (1 + slowest) * last < slowest * before ? last / (before - last) : slowest,
               decay = std::isinf(first) ? usual
                       : before < first  ? before / first
                                         : 1;
  return std::max(last * std::max(left, 1.0), before * decay);
}

Complex error_of(const Entry& entry, Complex value, double size) {
  const Complex along = value != 0.0 ? value / std::abs(value) : 1;
  return size * along * (entry.a == entry.b ? 1 : turn_of_errors);
}

void Refined::append(const Refined& other) {
  value.insert(value.end(), other.value.begin(), other.value.end());
  error.insert(error.end(), other.error.begin(), other.error.end());
  ordinates = std::max(ordinates, other.ordinates);
}

std::vector<double> scales(const std::vector<Entry>& entries, std::span<const Complex> values) {
  std::map<std::size_t, double> intensity;
  for (std::size_t e = 0; e < values.size(); ++e)
    if (entries[e].a == entries[e].b) intensity[entries[e].a] = std::abs(values[e]);
  std::vector<double> scale;
  for (std::size_t e = 0; e < values.size(); ++e) {
    const auto a = intensity.find(entries[e].a), b = intensity.find(entries[e].b);
    double reference = 0;
    if (a != intensity.end()) reference = a->second;
    if (b != intensity.end())
      reference = a != intensity.end() ? std::sqrt(reference * b->second) : b->second;
    scale.push_back(std::max(std::abs(values[e]), reference));
  }
  return scale;
}

std::vector<double> scales_with_derivatives(const std::vector<Entry>& entries,
                                            std::span<const Complex> values) {
  auto scale = scales(entries, values.first(entries.size()));
  if (values.size() == entries.size()) return scale;
  const auto derivative_scale = scales(entries, values.last(entries.size()));
  for (std::size_t e = 0; e < entries.size(); ++e)
    scale.push_back(std::max(scale[e], derivative_scale[e]));
  return scale;
}

Refined by_parameter(Refined all, double unit) {
  for (auto* list : {&all.value, &all.error})
    for (std::size_t i = list->size() / 2; i < list->size(); ++i) (*list)[i] /= unit;
  return all;
}

double worst_error(const Refined& refined, const std::vector<double>& scales) {
  double worst = 0;
  for (std::size_t i = 0; i < scales.size(); ++i)
    if (scales[i] > 0) worst = std::max(worst, std::abs(refined.error[i]) / scales[i]);
  return worst;
}

BatchJob two_batches(std::size_t size, const std::function<Refined()>& solve,
                     const Scales& scales) {
  struct Solution {
    std::once_flag once;
    Refined refined;
  };
  const auto solution = std::make_shared<Solution>();
  BatchJob job;
  job.size = size;
  job.samples_per_batch = 1;
  job.one_by_one = true;
  job.run = [=](std::uint64_t number, std::span<Complex> sums) {
    std::call_once(solution->once, [&] { solution->refined = solve(); });
    const double sign = number % 2 == 0 ? 1 : -1;
    for (std::size_t e = 0; e < sums.size(); ++e)
      sums[e] += solution->refined.value[e] + sign * solution->refined.error[e];
  };
  job.relative_error = [scales](const GroupedSums& sums) {
    const Estimate all = jackknife(sums, sample_mean);
    return worst_error({all.value, {all.error.begin(), all.error.end()}}, scales(all.value));
  };
  return job;
}

void write_numerical(ResultFile& file, const std::string& group) {
  ResultGroup(file, numerical_table, group)
      .attribute("errors", "numerical: differences from fewer ordinates");
}

}  // namespace flatspeckle::mc
