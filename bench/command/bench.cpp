#include <algorithm>
#include <cstdio>
#include <mutex>
#include <numeric>
#include <unistd.h>

#include <omp.h>

#include "apps/command/subcommands.h"
#include "bench/command/bench_output.h"
#include "core/error.h"
#include "core/run/parallel.h"
#include "core/run/stopwatch.h"
#include "core/session/session.h"

namespace flatspeckle::apps {

namespace {

struct BenchKeys : Words {
  bool quick = false;
  long every = 1;
  RunSettings run;
};

/// Prints a line on standard output for each finished part of a benchmark, and on a terminal a
/// progress line on standard error. Thread-safe.
class BenchLog {
 public:
  /// parts: name of the parts in the plural, such as "curves".
  BenchLog(std::size_t count, std::string parts) : count_(count), parts_(std::move(parts)) {}
  ~BenchLog() { clear(); }

  void finished(const std::string& line) {
    const std::lock_guard lock(mutex_);
    ++done_;
    clear();
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
    if (terminal_)
      std::fprintf(stderr, "bench: %zu of %zu %s, %.0f s", done_, count_, parts_.c_str(),
                   clock_.seconds());
  }

 private:
  void clear() const {
    if (terminal_) std::fputs("\r\033[K", stderr);
  }

  std::size_t count_, done_ = 0;
  std::string parts_;
  bool terminal_ = isatty(STDERR_FILENO) == 1;
  Stopwatch clock_;
  std::mutex mutex_;
};

/// Outcome of one kind of benchmark.
struct Outcome {
  std::string plan, parts;
  std::size_t count, failed;
};

template <typename... Values>
std::string text(const char* format, Values... values) {
  char line[400];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

/// Returns every n-th row, beginning with the first.
template <typename Row>
std::vector<Row> thinned(std::vector<Row> rows, long every) {
  std::vector<Row> kept;
  for (std::size_t i = 0; i < rows.size(); i += static_cast<std::size_t>(every))
    kept.push_back(std::move(rows[i]));
  return kept;
}

/// Calls run(i) in parallel for all i, starting them in this order.
template <typename Run>
void run_all(const std::vector<std::size_t>& order, const Run& run) {
  parallel_for(order.size(), [&](std::size_t i) { run(order[i]); });
}

std::vector<std::size_t> in_order(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

std::string line_of(const bench::ErrorCurve& curve, bool good) {
  if (!curve.has_slope())
    return text("%-24s %-22s error %.1e in %.2g s, %.1e in %.2g s", curve.scene.c_str(),
                curve.method.c_str(), curve.points.front().error, curve.points.front().cpu_s,
                curve.points.back().error, curve.points.back().cpu_s);
  return text("%-24s %-22s slope %6.3f +- %5.3f, efficiency %9.3g /s%s", curve.scene.c_str(),
              curve.method.c_str(), curve.slope, curve.slope_error, curve.efficiency,
              good ? "" : "  FAILED");
}

std::string line_of(const bench::CostCurve& cost) {
  return text("%-47s cost grows as %s^(%.2f +- %.2f), expected %.2f", cost.what.c_str(),
              cost.size_name.c_str(), cost.exponent, cost.exponent_error, cost.expected);
}

std::string line_of(const ExaminedCase& row, bool good) {
  const auto& [extreme, finding, cpu_s] = row;
  const std::string head = text("%-12s %-52s %-44s ", extreme.module_name.c_str(),
                                extreme.name.c_str(), extreme.invariant.c_str());
  if (finding.refusal.empty())
    return head +
           text("%10.1e %10.1e %s", finding.figure, finding.limit, good ? "passed" : "FAILED");
  return head + (good ? "refused: " : "FAILED, refused: ") + finding.refusal;
}

std::string line_of(const bench::PlanRow& row) {
  return text(
      "%-12s %-30s %-34s %10.3g %10.3g s per %-10s ratio %6.2f +- %4.2f, difference %.1e %s%s",
      row.module_name.c_str(), row.left_out.c_str(), row.scene.c_str(), row.general_s,
      row.special_s, row.per.c_str(), row.ratio, row.ratio_spread, row.difference,
      row.difference_in.c_str(), passes(row) ? "" : "  FAILED");
}

/// Whether the error of a Monte Carlo curve falls as time^(-1/2). True for all other curves.
bool has_monte_carlo_slope(const bench::ErrorCurve& curve) {
  constexpr double tolerance = 0.05;
  return !curve.is_monte_carlo || std::abs(curve.slope + 0.5) <= tolerance;
}

Outcome error_against_time(ResultFile& file, bool quick, long every) {
  const double cpu_seconds = quick ? 0.05 : 30;
  auto runs = bench::error_runs();
  if (quick) std::erase_if(runs, [](const auto& run) { return run.slow; });
  runs = thinned(std::move(runs), every);
  const auto costs = thinned(bench::cost_runs(), every);
  std::vector<bench::ErrorCurve> curves(runs.size());
  std::vector<bench::CostCurve> growth(costs.size());
  BenchLog log(runs.size() + costs.size(), "curves");
  run_all(in_order(runs.size() + costs.size()), [&](std::size_t i) {
    if (i < runs.size()) {
      curves[i] = runs[i].run(cpu_seconds);
      log.finished(line_of(curves[i], quick || has_monte_carlo_slope(curves[i])));
    } else {
      auto& cost = growth[i - runs.size()];
      cost = costs[i - runs.size()].run(cpu_seconds);
      log.finished(line_of(cost));
    }
  });
  write_error_curves(file, curves);
  write_cost_curves(file, growth);
  const auto failed = std::count_if(curves.begin(), curves.end(), [&](const auto& curve) {
    return !quick && !has_monte_carlo_slope(curve);
  });
  return {
      text("%g CPU seconds for each curve%s", cpu_seconds, quick ? ", without the slow ones" : ""),
      "curves", runs.size() + costs.size(), static_cast<std::size_t>(failed)};
}

Outcome stability(ResultFile& file, bool quick, long every) {
  std::vector<ExaminedCase> cases;
  for (auto& extreme : bench::extreme_cases())
    if (!quick || !extreme.slow) cases.push_back({std::move(extreme), {}});
  cases = thinned(std::move(cases), every);
  auto order = in_order(cases.size());
  std::stable_partition(order.begin(), order.end(),
                        [&](std::size_t i) { return cases[i].extreme.slow; });
  BenchLog log(cases.size(), "cases");
  run_all(order, [&](std::size_t i) {
    const double start = thread_cpu_seconds();
    cases[i].finding = examine(cases[i].extreme);
    cases[i].cpu_s = thread_cpu_seconds() - start;
    log.finished(line_of(cases[i], passes(cases[i].extreme, cases[i].finding)));
  });
  write_cases(file, cases);
  const auto failed = std::count_if(cases.begin(), cases.end(), [](const auto& row) {
    return !passes(row.extreme, row.finding);
  });
  return {quick ? "without the slow cases" : "all cases", "cases", cases.size(),
          static_cast<std::size_t>(failed)};
}

/// Times the kernels one at a time, because concurrent ones would compete for memory bandwidth.
Outcome savings_of_plans(ResultFile& file, bool quick, long every) {
  const double cpu_seconds = quick ? 0.02 : 4;
  omp_set_num_threads(1);
  std::vector<bench::PlanRow> rows;
  const auto cases = thinned(bench::plan_cases(), every);
  BenchLog log(cases.size(), "comparisons");
  for (const auto& comparison : cases) {
    rows.push_back(comparison(cpu_seconds));
    log.finished(line_of(rows.back()));
  }
  write_plan_rows(file, rows);
  const auto failed =
      std::count_if(rows.begin(), rows.end(), [](const auto& row) { return !passes(row); });
  return {text("%g CPU seconds for each comparison, one at a time", cpu_seconds), "comparisons",
          rows.size(), static_cast<std::size_t>(failed)};
}

using Report = Outcome (*)(ResultFile&, bool quick, long every);

Report report_named(const std::string& word) {
  if (word == "error") return error_against_time;
  if (word == "stability") return stability;
  if (word == "plan") return savings_of_plans;
  throw InputError("bench", word, "must be one of error stability plan");
}

void add_keys(Keys& keys, BenchKeys& values) {
  keys.group("Benchmark");
  keys.add("quick", values.quick, "Short run: about a minute instead of many");
  keys.add("every", values.every, "Run only every n-th row, beginning with the first").positive();
  add_thread_key(keys, values.run);
  add_output_key(keys, values.run);
}

int run_benchmark(const Subcommand& command, BenchKeys& values) {
  const Keys& keys = command.keys();
  if (values.words.empty()) throw InputError("bench: must be followed by error, stability or plan");
  const Report kind = report_named(values.text());
  const Session session(command.text(), keys, values.run, command.only_prints());
  keys.read(values.quick);
  keys.read(values.every);
  if (!command.settle()) return ExitStatus::done;
  omp_set_num_threads(session.threads());
  return session.once(ResultFile(session.out()), [&](ResultFile& file) {
    const Stopwatch clock;
    const Outcome outcome = kind(file, values.quick, values.every);
    std::printf("%zu %s, %zu failed, %.0f s\n", outcome.count, outcome.parts.c_str(),
                outcome.failed, clock.seconds());
    return Made{outcome.plan, static_cast<double>(outcome.count),
                outcome.failed == 0 ? ExitStatus::done : ExitStatus::row_failed};
  });
}

}  // namespace

std::unique_ptr<Call> bench(const std::string&) {
  return call_with<BenchKeys>(
      "bench",
      "Error against processor time (bench error), extreme cases (bench stability), and "
      "savings of specialised kernels (bench plan)",
      run_benchmark);
}

}  // namespace flatspeckle::apps
