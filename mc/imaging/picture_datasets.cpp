#include "mc/imaging/picture_datasets.h"

#include <algorithm>

#include "core/result/result_group.h"
#include "mc/imaging/media_statistics.h"
#include "mc/imaging/picture_prediction.h"
#include "mc/imaging/recovery/recovery_datasets.h"

namespace flatspeckle::mc {

const DatasetTable picture_table{
    .name = "picture",
    .rows = {{"picture_x", Data::scale, "", "length", "place on the object's line"},
             {"reference_x", Data::real, "", "length", "of the reference point"},
             {"reference_frame", Data::real, "repeat camera_place", "1",
              "of the reference point alone, in units of the light's mean"},
             {"true_picture", Data::real, "picture_x", "1",
              "the object, a Gaussian as wide as a grain for each point"},
             {"picture", Data::real, "repeat picture_x", "1",
              "frames divided by their reference; the scale is free"},
             {"psnr", Data::real, "repeat", "1",
              "dB: the largest value of the true picture over the rms difference"},
             {"mean_psnr", Data::estimate, "", "1", "mean over the media"},
             {"predicted_psnr", Data::real, "", "1", "without pictures, of Wiener's filter"},
             {"iteration", Data::numbers, "", "1", "number of the step (richardson_lucy)"},
             {"residual", Data::real, "repeat iteration", "1",
              "rms of what the frame differs by from picture and reference, over its mean"},
             {"reference_correlation", Data::estimate, "point", "1",
              "C_I of each point's speckle and the reference's, from light paths"}}};

double expected_psnr(const LineScene& line, const ImagingTask& task,
                     const ImagingPrediction& prediction) {
  return predicted_psnr(line, real_parts(prediction.to_reference.value), task.recovery.noise,
                        task.recovery.lags, task.deconvolution.regularisation);
}

namespace {

void write_residuals(const ResultGroup& root, const std::vector<ImagedMedium>& media) {
  const std::size_t steps = media.front().deconvolved.residual.size();
  root.number("iteration", steps);
  root.put("residual",
           of_each(media, steps, [](const ImagedMedium& m) { return m.deconvolved.residual; }));
}

}  // namespace

void write_pictures(ResultFile& file, const LineScene& line, const ImagingTask& task,
                    const std::vector<ImagedMedium>& media, const ImagingPrediction& prediction) {
  const ResultGroup root(file, picture_table);
  root.put("reference_x", *line.reference);
  root.put("reference_correlation", prediction.to_reference);
  if (task.deconvolution.method == DeconvolutionTask::Method::wiener)
    root.put("predicted_psnr", expected_psnr(line, task, prediction));
  if (media.empty()) return;
  const std::size_t lags = task.recovery.lags, shown = 2 * lags - 1;
  const bool mirrored = magnification(line) < 0;
  std::vector<double> places;
  for (std::size_t p = 0; p < shown; ++p)
    places.push_back(*line.reference + (static_cast<double>(p) - static_cast<double>(lags - 1)) /
                                           std::abs(magnification(line)));
  const auto turned = [&](std::vector<double> picture) {
    if (mirrored) std::reverse(picture.begin(), picture.end());
    return picture;
  };
  root.put("picture_x", places);
  root.put("reference_frame",
           of_each(media, line.camera.pixels, [](const ImagedMedium& m) { return m.reference; }));
  root.put("true_picture",
           turned(point_picture(shifts(line), lags, media.front().deconvolved.grain)));
  root.put("picture", of_each(media, shown, [&](const ImagedMedium& m) {
             return turned(m.deconvolved.picture);
           }));
  root.put("psnr", column(media, [](const ImagedMedium& m) { return m.psnr; }));
  const MeanOverMedia mean = mean_psnr(media);
  root.put("mean_psnr", mean.value, mean.error);
  if (task.deconvolution.method == DeconvolutionTask::Method::richardson_lucy)
    write_residuals(root, media);
}

}  // namespace flatspeckle::mc
