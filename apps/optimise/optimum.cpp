#include "apps/optimise/optimum.h"

#include <cmath>
#include <cstdio>

#include "apps/results/datasets.h"
#include "apps/sweep/varied_points.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"

namespace flatspeckle::apps {

const DatasetTable optimum_table{
    .name = "optimise",
    .rows = {{"search/evaluation", Data::numbers, "", "1", "number of the evaluation"},
             {"search/value", Data::estimate, "search/evaluation", "",
              "what was made as large or small as can be"},
             {"search/samples", Data::real, "search/evaluation", "1", "samples"},
             {"search/cpu_s", Data::real, "search/evaluation", "s", "processor time, all threads"},
             {"search/draw", Data::count, "search/evaluation", "1",
              "random numbers: 0 of the search, 1 of the choice among its ends, 2 of the value"},
             {"best/value", Data::estimate, "", "",
              "the value at the best place, by random numbers of its own"},
             {"best/lead", Data::estimate, "", "", "by how much it is better than the runner-up"},
             {"best/confidence", Data::real, "", "1", "that it is better"},
             {"best/gain", Data::estimate, "", "1",
              "value at the best place over with the keys of against"},
             {"runner_up/value", Data::estimate, "", "", "the value there"},
             {"against/value", Data::estimate, "", "", "the value there"}},
    .attributes = {{"", "of", "text", "the subcommand whose results these are"},
                   {"", "objective", "text", "the number of its result that was searched for"},
                   {"", "objective_unit", "text", "of the values here"},
                   {"", "complete", "bool", "0: the time was up before the search had ended"},
                   {"search", "swept", "texts", "the keys that were searched"},
                   {"best", "at_bounds", "texts",
                    "keys whose best value is a bound of their range, if there are any: a wider "
                    "one may have a better"}}};

namespace {

double sign_of(const EvaluationSettings& settings) {
  return settings.minimise ? -1 : 1;
}

void put(const ResultGroup& root, const std::string& name, double value, double error) {
  root.put(name, value, error);
}

/// The keys of a place under their names, as datasets without axes; those of many as columns.
void write_keys(ResultFile& file, const std::string& group, const std::vector<SweepPoints>& points,
                const std::vector<Axis>& axes, const Keys& keys) {
  for (std::size_t i = 0; i < points.front().axes.size(); ++i) {
    const SweepAxis& axis = points.front().axes[i];
    const Key& key = *keys.find(key_of(axis));
    std::vector<std::string> texts;
    std::vector<double> values;
    for (const SweepPoints& point : points) {
      texts.push_back(point.value(i, 0));
      if (key.is_number()) values.push_back(*read_number(texts.back()));
    }
    const std::string name = group + '/' + axis_name(axis);
    const std::string unit = key.unit().empty() ? "1" : key.unit();
    if (key.is_number())
      file.dataset(name, std::span<const double>(values), axes, unit, key.help());
    else
      file.dataset(name, std::span<const std::string>(texts), axes, "", key.help());
  }
}

void write_search(ResultFile& file, const ResultGroup& root, const Evaluations& evaluations,
                  double sign, const Keys& keys) {
  const auto& all = evaluations.all();
  root.number("search/evaluation", all.size());
  std::vector<SweepPoints> points;
  std::vector<double> values, errors;
  for (const Evaluation& one : all) {
    points.push_back(one.point);
    values.push_back(sign * one.found.value);
    errors.push_back(error(one.found));
  }
  write_keys(file, "search", points, {Axis("search/evaluation")}, keys);
  root.put("search/value", std::span<const double>(values), errors);
  root.put("search/samples", column(all, &Evaluation::samples));
  root.put("search/cpu_s", column(all, &Evaluation::cpu_s));
  root.put("search/draw", column(all, [](const Evaluation& one) { return one.effort.draw; }));
  std::vector<std::string> names;
  for (const SweepAxis& axis : points.front().axes) names.push_back(axis_name(axis));
  root.attribute("search", "swept", names);
}

std::string keys_text(const SweepPoints& point) {
  std::string text;
  for (const SweepAxis& axis : point.axes)
    text += (text.empty() ? "" : ", ") + axis.key + " = " + axis.values.front();
  return text;
}

}  // namespace

void write_optimum(ResultFile& file, const Optimum& optimum, const Evaluations& evaluations,
                   const EvaluationSettings& settings, const Keys& keys) {
  const auto& [best, runner_up, lead, reached] = optimum.winner;
  const double sign = sign_of(settings);
  const ResultGroup root(file, optimum_table);
  root.attribute("objective_unit", evaluations.dataset().units);
  write_search(file, root, evaluations, sign, keys);
  write_keys(file, "best", {optimum.best}, {}, keys);
  if (!optimum.at_bounds.empty()) root.attribute("best", "at_bounds", optimum.at_bounds);
  put(root, "best/value", sign * best.measured.value, error(best.measured));
  write_keys(file, "runner_up", {optimum.runner_up}, {}, keys);
  put(root, "runner_up/value", sign * runner_up.measured.value, error(runner_up.measured));
  put(root, "best/lead", lead.value, lead.error);
  root.put("best/confidence", lead.confidence());
  if (!optimum.there) return;
  const Measured gain = ratio(best.measured, *optimum.there);
  write_keys(file, "against", {*optimum.against}, {}, keys);
  put(root, "against/value", sign * optimum.there->value, error(*optimum.there));
  if (optimum.there->value != 0) put(root, "best/gain", gain.value, error(gain));
}

void print_optimum(const Optimum& optimum, const EvaluationSettings& settings) {
  const auto& [best, runner_up, lead, reached] = optimum.winner;
  const double sign = sign_of(settings);
  const auto print = [&](const char* what, const SweepPoints& point, const Measured& found) {
    std::printf("%-10s %.6g +- %.2g at %s\n", what, sign * found.value, error(found),
                keys_text(point).c_str());
  };
  print("best", optimum.best, best.measured);
  const bool has_other = runner_up.place != best.place;
  if (has_other) {
    print("runner-up", optimum.runner_up, runner_up.measured);
    std::printf("better by %.3g +- %.2g, with a confidence of %.4g\n", lead.value, lead.error,
                lead.confidence());
  }
  std::puts(
      "the best that the scattered places led to: more of them (scattered), or a map, tell whether "
      "there is better");
  if (has_other && std::abs(lead.value) < 2 * lead.error)
    std::puts(
        "not told apart: their values are equal within the errors, as on a plateau; either will "
        "do (the best\nwas chosen by earlier random numbers, of which these know nothing; a "
        "smaller target_error tells more)");
  if (!optimum.at_bounds.empty())
    std::printf("at a bound of its range: %s; a wider one may have a better place\n",
                joined(optimum.at_bounds, ", ").c_str());
  if (!optimum.there) return;
  print("against", *optimum.against, *optimum.there);
  if (optimum.there->value == 0) return;
  const Measured gain = ratio(best.measured, *optimum.there);
  std::printf("%-10s %.6g +- %.2g\n", "gain", gain.value, error(gain));
}

}  // namespace flatspeckle::apps
