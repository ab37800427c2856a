#include "mc/imaging/retrieval/picture_datasets.h"

namespace flatspeckle::mc {

const DatasetTable recovered_picture_table{
    .name = "recovered_pictures",
    .rows = {
        {"frame", Data::numbers, "", "1",
         "number of the frame, or of the group of frames that the key average defines"},
        {"frame_name", Data::text, "frame", "",
         "name or number of the frame; for a group, of its first frame"},
        {"lag_x", Data::scale, "", "1", "lag along the rows in pixels"},
        {"lag_y", Data::scale, "", "1", "lag along the columns in pixels"},
        {"autocorrelation", Data::real, "frame lag_y lag_x", "1",
         "<dI dI'> / <I>^2 of the frame divided by its envelope, without camera noise"},
        {"contrast", Data::real, "frame", "1",
         "standard deviation over mean of the frame divided by its envelope, without camera noise"},
        {"grain", Data::real, "frame", "1",
         "full width at half maximum of the autocorrelation about lag 0, in pixels"},
        {"white_noise", Data::real, "frame", "1",
         "camera noise: variance over squared mean, subtracted at lag 0"},
        {"noise", Data::real, "frame", "1", "standard deviation of the autocorrelation"},
        {"invariants/variance", Data::invariant, "frame", "1",
         "relative difference between the autocorrelation at lag 0, camera noise included, and the "
         "variance of the pixels"},
        {"picture_x", Data::numbers, "", "1", "column of the picture in pixels"},
        {"picture_y", Data::numbers, "", "1", "row of the picture in pixels"},
        {"phased_picture", Data::real, "frame picture_y picture_x", "1",
         "object by phase retrieval, at an arbitrary shift, rotated by 180 degrees or not; the sum "
         "is 1"},
        {"phase_iteration", Data::numbers, "", "1", "number of the iteration of phase retrieval"},
        {"phase_residual", Data::real, "frame phase_iteration", "1",
         "rms of the estimate where it is negative or beyond the lags, over the rms of the whole "
         "estimate"},
        {"sought", Data::numbers, "", "1", "number of the sought point"},
        {"found_x", Data::real, "frame sought", "1",
         "columns of the found points in pixels from the first, rotated by 180 degrees or not"},
        {"found_y", Data::real, "frame sought", "1", "their rows in pixels from the first"},
        {"found_brightness", Data::real, "frame sought", "1",
         "brightness of the found points, mean 1; 0 if no point was found"},
        {"explained", Data::real, "frame", "1",
         "agreement of the brightness with the peaks of all pairs, at most 1"},
        {"agreement", Data::real, "frame", "1",
         "mean correlation between the picture and those of the better half of the other starts"}}};

namespace {

void write_places(const ResultGroup& root, std::size_t sought,
                  const std::vector<RecoveredPicture>& all) {
  root.number("sought", sought);
  const auto put = [&](const char* name, std::vector<double> PicturePoints::*member) {
    std::vector<double> values;
    for (const RecoveredPicture& one : all) {
      std::vector<double> own = one.points.*member;
      own.resize(sought);
      values.insert(values.end(), own.begin(), own.end());
    }
    root.put(name, values);
  };
  put("found_x", &PicturePoints::x);
  put("found_y", &PicturePoints::y);
  put("found_brightness", &PicturePoints::brightness);
  root.put("explained", column(all, [](const auto& one) { return one.points.explained; }));
}

}  // namespace

void write_pictures(ResultFile& file, const std::vector<std::string>& names, std::size_t lags,
                    std::size_t sought, const std::vector<RecoveredPicture>& all) {
  const ResultGroup root(file, recovered_picture_table);
  std::vector<double> lag, autocorrelation, picture, residual;
  for (std::size_t i = 0; i < 2 * lags - 1; ++i)
    lag.push_back(static_cast<double>(i) - static_cast<double>(lags - 1));
  std::vector<Invariant> variances;
  const auto append = [](std::vector<double>& to, const std::vector<double>& values) {
    to.insert(to.end(), values.begin(), values.end());
  };
  for (const auto& [statistics, retrieved, points] : all) {
    append(autocorrelation, statistics.autocorrelation);
    append(picture, retrieved.picture);
    append(residual, retrieved.residual);
    variances.push_back(statistics.variance);
  }
  root.number("frame", all.size());
  root.put("frame_name", names);
  root.put("lag_x", lag);
  root.put("lag_y", lag);
  root.put("autocorrelation", autocorrelation);
  const auto put = [&](const char* name, double PictureStatistics::*member) {
    root.put(name,
             column(all, [&](const RecoveredPicture& one) { return one.statistics.*member; }));
  };
  put("contrast", &PictureStatistics::contrast);
  put("grain", &PictureStatistics::grain);
  put("white_noise", &PictureStatistics::white);
  put("noise", &PictureStatistics::noise);
  root.check("invariants/variance", variances);
  if (sought > 0) return write_places(root, sought, all);
  root.number("picture_x", lags);
  root.number("picture_y", lags);
  root.put("phased_picture", picture);
  root.number("phase_iteration", all.front().retrieved.residual.size());
  root.put("phase_residual", residual);
  root.put("agreement",
           column(all, [](const RecoveredPicture& one) { return one.retrieved.agreement; }));
}

}  // namespace flatspeckle::mc
