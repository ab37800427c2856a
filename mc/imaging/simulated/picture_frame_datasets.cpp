#include "mc/imaging/simulated/picture_frame_datasets.h"

#include <algorithm>
#include <cmath>

#include "mc/imaging/recovery/recovery_datasets.h"

namespace flatspeckle::mc {

const DatasetTable simulated_picture_table{
    .name = "simulated_pictures",
    .rows =
        {{"object_point", Data::numbers, "", "1", "number of the point of the object in space"},
         {"point_x", Data::real, "object_point", "PLACE", "x of the object's points"},
         {"point_y", Data::real, "object_point", "PLACE", "y of the object's points"},
         {"point_z", Data::real, "object_point", "length",
          "depth of the object's points, if they are not at infinity"},
         {"point_light", Data::real, "object_point", "1", "relative brightness of the points"},
         {"picture_number", Data::numbers, "", "1", "number of the recovered picture"},
         {"camera_frame", Data::numbers, "", "1",
          "number of the frame, each through another medium"},
         {"pixel_row", Data::numbers, "", "1", "row of the camera, along y"},
         {"pixel_column", Data::numbers, "", "1", "column of the camera, along x"},
         {"frames", Data::real, "camera_frame pixel_row pixel_column", "1",
          "frames of the camera: electrons, or values of bit_depth bits; without photons, light "
          "over its mean"},
         {"saturated", Data::real, "picture_number", "1",
          "fraction of the pixels that are saturated"},
         {"light_contrast", Data::real, "picture_number", "1",
          "contrast of the light of the picture's first frame, before camera noise"},
         {"frame_grain", Data::real, "picture_number", "1",
          "full width at half maximum of the autocorrelation of the picture's frames, in pixels"},
         {"white_noise", Data::real, "picture_number", "1",
          "camera noise: variance over squared mean, subtracted at lag 0"},
         {"place_x", Data::scale, "", "PLACE", "x of a column of the recovered pictures"},
         {"place_y", Data::scale, "", "PLACE", "y of a row of the recovered pictures"},
         {"true_picture", Data::real, "place_y place_x", "1",
          "the object, with a Gaussian as wide as a recovered point for each point; the sum is 1"},
         {"recovered_picture", Data::real, "picture_number place_y place_x", "1",
          "object by phase retrieval, at the shift and rotation of best agreement with the true "
          "one; the sum is 1"},
         {"agreement", Data::real, "picture_number", "1",
          "mean correlation between the picture and those of the better half of the other starts"},
         {"similarity", Data::real, "picture_number", "1",
          "structural similarity of the recovered and the true picture"},
         {"recovered", Data::estimate, "", "1",
          "fraction of the pictures whose similarity exceeds least_similarity"},
         {"predicted_similarity", Data::estimate, "", "1",
          "mean similarity expected from C_I, the grains and the camera noise, without frames"},
         {"predicted_recovery", Data::real, "", "1",
          "probability that the similarity exceeds least_similarity, from the same prediction"},
         {"resolution", Data::real, "", "PLACE",
          "full width at half maximum of a point in the recovered picture"},
         {"field_of_view", Data::real, "", "PLACE",
          "distance of two points at which C_I of their speckles is 1/2, if it lies within "
          "separation"},
         {"separation", Data::scale, "", "PLACE", "distance of two points of the object"},
         {"separation_correlation", Data::estimate, "separation", "1",
          "C_I of the speckles of two points at this distance, from light paths"},
         {"speckle_lag", Data::numbers, "", "1", "lag in pixels"},
         {"speckle_peak_x", Data::real, "speckle_lag", "1",
          "autocorrelation of the intensity of speckle of unit variance, along x"},
         {"speckle_peak_y", Data::real, "speckle_lag", "1",
          "autocorrelation of the intensity of speckle of unit variance, along y"},
         {"exposure_factor", Data::real, "", "1",
          "factor of the squared contrast by the motion during the exposure"},
         {"invariants/variance", Data::invariant, "picture_number", "1",
          "relative difference between the autocorrelation at lag 0, camera noise included, and "
          "the "
          "variance of the pixels"}},
    .roles = {{"PLACE", {"1", "length"}}}};

MeanOverMedia PictureResult::success(double least_similarity) const {
  const auto n = static_cast<double>(pictures.size());
  const auto found =
      static_cast<double>(std::ranges::count_if(pictures, [&](const SimulatedPicture& one) {
        return one.score.similarity > least_similarity;
      }));
  return share_of(found, n);
}

namespace {

void write_object(const ResultGroup& root, const PictureObject& object) {
  root.number("object_point", object.place.size());
  root.put("point_x", column(object.place, &Vec::x));
  root.put("point_y", column(object.place, &Vec::y));
  if (!object.far) root.put("point_z", column(object.place, &Vec::z));
  root.put("point_light", object.brightness);
}

void write_speckle(const ResultGroup& root, const SpecklePrediction& speckle, double scale) {
  root.put("separation", speckle.separation);
  root.put("separation_correlation", speckle.correlation);
  root.number("speckle_lag", speckle.grain_x.size());
  root.put("speckle_peak_x", speckle.grain_x);
  root.put("speckle_peak_y", speckle.grain_y);
  root.put("exposure_factor", speckle.exposure);
  root.put("resolution", point_width_of(speckle.grain()) / scale);
  if (const auto view = speckle.field_of_view()) root.put("field_of_view", *view);
}

/// Concatenates lists of the pictures.
template <class Value>
std::vector<double> concatenated(const std::vector<SimulatedPicture>& pictures,
                                 const Value& value) {
  std::vector<double> all;
  for (const SimulatedPicture& one : pictures) {
    const auto& values = value(one);
    all.insert(all.end(), values.begin(), values.end());
  }
  return all;
}

void write_pictures_of(const ResultGroup& root, const PictureTask& task,
                       const PictureResult& result) {
  const auto& pictures = result.pictures;
  const Frames& first = pictures.front().frames;
  root.number("picture_number", pictures.size());
  root.number("camera_frame", pictures.size() * first.count());
  root.number("pixel_row", first.rows);
  root.number("pixel_column", first.columns);
  root.put("frames", concatenated(pictures, [](const auto& one) { return one.frames.values; }));
  root.put("recovered_picture",
           concatenated(pictures, [](const auto& one) { return one.score.aligned; }));
  const auto each = [&](const char* name, auto value) { root.put(name, column(pictures, value)); };
  each("saturated", &SimulatedPicture::saturated);
  each("light_contrast", &SimulatedPicture::light_contrast);
  each("frame_grain", [](const SimulatedPicture& one) { return one.statistics.grain; });
  each("white_noise", [](const SimulatedPicture& one) { return one.statistics.white; });
  each("agreement", [](const SimulatedPicture& one) { return one.retrieved.agreement; });
  each("similarity", [](const SimulatedPicture& one) { return one.score.similarity; });
  const auto [share, error] = result.success(task.least_similarity);
  root.put("recovered", share, error);
  std::vector<Invariant> variances;
  for (const auto& one : pictures) variances.push_back(one.statistics.variance);
  root.check("invariants/variance", variances);
}

}  // namespace

void write_simulated(ResultFile& file, const PictureScene& scene, const PictureTask& task,
                     const PictureResult& result) {
  file.bind("PLACE", {scene.object.far ? "1" : "length"});
  const ResultGroup root(file, simulated_picture_table);
  write_object(root, scene.object);
  const double scale = picture_scale(scene), half = (static_cast<double>(task.lags) - 1) / 2;
  write_speckle(root, result.speckle, scale);
  const Vec middle = middle_of(scene.object);
  std::vector<double> x, y;
  for (std::size_t p = 0; p < task.lags; ++p) {
    x.push_back(middle.x + (static_cast<double>(p) - half) / scale);
    y.push_back(middle.y + (static_cast<double>(p) - half) / scale);
  }
  root.put("place_x", x);
  root.put("place_y", y);
  root.put("true_picture", result.truth);
  if (task.draws > 0) {
    root.put("predicted_similarity", result.prediction.similarity,
             result.prediction.similarity_error);
    root.put("predicted_recovery", result.prediction.success);
  }
  if (!result.pictures.empty()) write_pictures_of(root, task, result);
}

}  // namespace flatspeckle::mc
