#include "mc/imaging/recovery_datasets.h"

#include "core/result/result_group.h"

namespace flatspeckle::mc {

const DatasetTable recovery_table{
    .name = "recover",
    .rows = {
        {"frame", Data::numbers, "", "1", "number of the frame"},
        {"frame_name", Data::text, "frame", "", "its column"},
        {"lag", Data::numbers, "", "1", "pixels"},
        {"sought", Data::numbers, "", "1", "number of the point that was looked for"},
        {"autocorrelation", Data::real, "frame lag", "1",
         "<dI dI'> / <I>^2 of the frame without its envelope"},
        {"contrast", Data::real, "frame", "1", "standard deviation over mean, without envelope"},
        {"grains", Data::real, "frame", "1", "independent speckle grains in the frame"},
        {"noise", Data::real, "frame", "1", "standard deviation of the autocorrelation"},
        {"found_x", Data::real, "frame sought", "1", "pixels from the first, mirrored or not"},
        {"found_brightness", Data::real, "frame sought", "1",
         "relative, mean 1; 0 where nothing was found"},
        {"explained", Data::real, "frame", "1",
         "how well the brightness fits the peaks of all pairs, at most 1"}}};

namespace {

template <class Value>
std::vector<double> of_each(const std::vector<Recovered>& all, std::size_t count,
                            const Value& value) {
  std::vector<double> joined;
  for (const Recovered& one : all) {
    std::vector<double> values = value(one);
    values.resize(count);
    joined.insert(joined.end(), values.begin(), values.end());
  }
  return joined;
}

}  // namespace

void write_recovery(ResultFile& file, const std::vector<std::string>& names,
                    const RecoveryTask& task, const std::vector<Recovered>& all) {
  const ResultGroup root(file, recovery_table);
  root.number("frame", all.size());
  root.put("frame_name", names);
  root.number("lag", task.lags);
  root.number("sought", task.points);
  root.put("autocorrelation", of_each(all, task.lags, [](const Recovered& one) {
             return one.statistics.autocorrelation;
           }));
  root.put("contrast", column(all, [](const Recovered& one) { return one.statistics.contrast; }));
  root.put("grains", column(all, [](const Recovered& one) { return one.statistics.grains; }));
  root.put("noise", column(all, [](const Recovered& one) { return one.statistics.noise; }));
  root.put("found_x",
           of_each(all, task.points, [](const Recovered& one) { return one.fit.object.x; }));
  root.put("found_brightness", of_each(all, task.points, [](const Recovered& one) {
             return one.fit.object.brightness;
           }));
  root.put("explained", column(all, [](const Recovered& one) { return one.fit.explained; }));
}

}  // namespace flatspeckle::mc
