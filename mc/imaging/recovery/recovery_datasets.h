#pragma once

#include <string>
#include <vector>

#include "core/result/result_group.h"
#include "mc/imaging/recovery/deconvolution.h"
#include "mc/imaging/recovery/phase_retrieval.h"
#include "mc/imaging/recovery/recovery.h"

namespace flatspeckle::mc {

extern const DatasetTable recovery_table;

/// Concatenates the values of all items, each padded with zeros to `count` values.
template <class All, class Value>
std::vector<double> of_each(const All& all, std::size_t count, const Value& value) {
  std::vector<double> all_values;
  for (const auto& one : all) {
    std::vector<double> values = value(one);
    values.resize(count);
    all_values.insert(all_values.end(), values.begin(), values.end());
  }
  return all_values;
}

/// Writes the statistics of each frame, which do not depend on a search.
template <class All>
void write_statistics(const ResultGroup& root, const All& all) {
  const std::size_t lags = all.front().statistics.autocorrelation.size();
  root.put("autocorrelation",
           of_each(all, lags, [](const Recovered& one) { return one.statistics.autocorrelation; }));
  root.put("contrast", column(all, [](const Recovered& one) { return one.statistics.contrast; }));
  root.put("grains", column(all, [](const Recovered& one) { return one.statistics.grains; }));
  root.put("noise", column(all, [](const Recovered& one) { return one.statistics.noise; }));
}

/// Writes the points that the search found in each frame; points that were not found are at 0 with
/// brightness 0.
template <class All>
void write_points(const ResultGroup& root, const All& all, std::size_t points,
                  double length_of_pixel) {
  root.number("sought", points);
  root.put("found_x", of_each(all, points, [&](const Recovered& one) {
             auto x = one.fit.object.x;
             for (double& each : x) each *= length_of_pixel;
             return x;
           }));
  root.put("found_brightness",
           of_each(all, points, [](const Recovered& one) { return one.fit.object.brightness; }));
}

void write_recovery(ResultFile& file, const std::vector<std::string>& names,
                    const RecoveryTask& task, const std::vector<Recovered>& all);

/// Writes pictures from frames deconvolved by a reference, in addition to the output of
/// write_recovery().
void write_deconvolved(ResultFile& file, const RecoveryTask& task,
                       const std::vector<Deconvolved>& all);

/// Writes pictures by phase retrieval, in addition to the output of write_recovery().
void write_phased(ResultFile& file, const RecoveryTask& task,
                  const std::vector<RetrievedPicture>& all);

}  // namespace flatspeckle::mc
