#include "mc/imaging/recovery/recovery_datasets.h"

namespace flatspeckle::mc {

const DatasetTable recovery_table{
    .name = "recover",
    .rows = {
        {"frame", Data::numbers, "", "1",
         "number of the frame, or of the group of frames that the key average defines"},
        {"frame_name", Data::text, "frame", "",
         "column of the frame; for a group, column of its first frame"},
        {"lag", Data::numbers, "", "1", "lag in pixels"},
        {"sought", Data::numbers, "", "1", "number of the sought point"},
        {"autocorrelation", Data::real, "frame lag", "1",
         "<dI dI'> / <I>^2 of the frame divided by its envelope"},
        {"contrast", Data::real, "frame", "1",
         "standard deviation over mean of the frame divided by its envelope"},
        {"grains", Data::real, "frame", "1", "number of independent speckle grains in the frame"},
        {"noise", Data::real, "frame", "1", "standard deviation of the autocorrelation"},
        {"found_x", Data::real, "frame sought", "1",
         "positions of the found points in pixels from the first, mirrored or not"},
        {"found_brightness", Data::real, "frame sought", "1",
         "brightness of the found points, mean 1; 0 if no point was found"},
        {"explained", Data::real, "frame", "1",
         "agreement of the brightness with the peaks of all pairs, at most 1"},
        {"invariants/variance", Data::invariant, "frame", "1",
         "relative difference between the autocorrelation at lag 0, camera noise included, and the "
         "variance of the pixels"},
        {"shift", Data::scale, "", "1", "shift from the reference in pixels"},
        {"picture", Data::real, "frame shift", "1", "frames deconvolved by their reference"},
        {"iteration", Data::numbers, "", "1", "number of the iteration (richardson_lucy)"},
        {"residual", Data::real, "frame iteration", "1",
         "rms difference between the frame and the reference convolved with the object, over the "
         "mean"},
        {"phased_picture", Data::real, "frame lag", "1",
         "object by phase retrieval, at an arbitrary shift, mirrored or not; the sum is 1"},
        {"phase_iteration", Data::numbers, "", "1", "number of the iteration of phase retrieval"},
        {"phase_residual", Data::real, "frame phase_iteration", "1",
         "rms of the estimate where it is negative or beyond the lags, over the rms of the whole "
         "estimate"}}};

void write_recovery(ResultFile& file, const std::vector<std::string>& names,
                    const RecoveryTask& task, const std::vector<Recovered>& all) {
  const ResultGroup root(file, recovery_table);
  root.number("frame", all.size());
  root.put("frame_name", names);
  root.number("lag", task.lags);
  write_statistics(root, all);
  constexpr double in_pixels = 1;
  write_points(root, all, task.points, in_pixels);
  root.put("explained", column(all, [](const Recovered& one) { return one.fit.explained; }));
  std::vector<Invariant> variances;
  for (const Recovered& one : all) variances.push_back(one.statistics.variance);
  root.check("invariants/variance", variances);
}

void write_deconvolved(ResultFile& file, const RecoveryTask& task,
                       const std::vector<Deconvolved>& all) {
  const ResultGroup root(file, recovery_table);
  std::vector<double> shifts;
  for (std::size_t p = 0; p < 2 * task.lags - 1; ++p)
    shifts.push_back(static_cast<double>(p) - static_cast<double>(task.lags - 1));
  root.put("shift", shifts);
  root.put("picture",
           of_each(all, shifts.size(), [](const Deconvolved& one) { return one.picture; }));
  const std::size_t steps = all.front().residual.size();
  if (steps == 0) return;
  root.number("iteration", steps);
  root.put("residual", of_each(all, steps, [](const Deconvolved& one) { return one.residual; }));
}

void write_phased(ResultFile& file, const RecoveryTask& task,
                  const std::vector<RetrievedPicture>& all) {
  const ResultGroup root(file, recovery_table);
  root.put("phased_picture",
           of_each(all, task.lags, [](const RetrievedPicture& one) { return one.picture; }));
  const std::size_t steps = all.front().residual.size();
  root.number("phase_iteration", steps);
  root.put("phase_residual",
           of_each(all, steps, [](const RetrievedPicture& one) { return one.residual; }));
}

}  // namespace flatspeckle::mc
