#include "mc/imaging/retrieval/contrast_datasets.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flatspeckle::mc {

const DatasetTable contrast_map_table{
    .name = "contrast_map",
    .rows = {
        {"map_column", Data::scale, "", "1", "column of the middle of the window, in pixels"},
        {"map_row", Data::scale, "", "1", "row of the middle of the window, in pixels"},
        {"mean_counts", Data::real, "map_row map_column", "1", "mean of the counts"},
        {"contrast_map", Data::estimate, "map_row map_column", "1",
         "squared speckle contrast K^2 = variance / mean^2, without camera noise"},
        {"window_correlation", Data::real, "", "1",
         "mean correlation of two pixels of a window, by which the bias of K^2 is corrected"},
        {"decay_rate", Data::estimate, "map_row map_column", "1",
         "rate of a field correlation exp(-rate t), per unit of the exposure, that gives this K^2; "
         "0 where K^2 is at least beta"},
        {"decay_rate_known", Data::count, "map_row map_column", "1",
         "whether K^2 is positive by more than its error, so that it gives a rate"},
        {"invariants/variance", Data::invariant, "", "1",
         "relative difference between the variance of the pixels and the sum of the variances "
         "within "
         "and between windows"}}};

void write_contrast(ResultFile& file, const ContrastMap& map, std::size_t window,
                    const std::optional<ExposureOfFrames>& exposure) {
  const ResultGroup root(file, contrast_map_table);
  const auto middles = [&](std::size_t count) {
    std::vector<double> places;
    for (std::size_t i = 0; i < count; ++i)
      places.push_back(static_cast<double>(i) + (static_cast<double>(window) - 1) / 2);
    return places;
  };
  root.put("map_column", middles(map.columns));
  root.put("map_row", middles(map.rows));
  root.put("mean_counts", map.mean);
  root.put("contrast_map", map.square, map.error);
  root.put("window_correlation", map.correlation);
  root.check("invariants/variance", {map.variance});
  if (!exposure) return;
  std::vector<double> rates, errors;
  std::vector<std::uint64_t> known;
  for (std::size_t p = 0; p < map.square.size(); ++p) {
    const auto rate = [&](double square) {
      return decays_per_exposure(square, exposure->beta) / exposure->exposure;
    };
    const bool positive = map.square[p] > map.error[p];
    known.push_back(positive ? 1 : 0);
    rates.push_back(positive ? rate(map.square[p]) : 0);
    const double step = map.error[p] / 2;
    errors.push_back(positive ? rate(map.square[p] - step) - rate(map.square[p] + step) : 0);
  }
  root.put("decay_rate", rates, errors);
  root.put("decay_rate_known", known);
}

}  // namespace flatspeckle::mc
