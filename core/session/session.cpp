#include "core/session/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <zlib.h>

#include <omp.h>

#include "core/error.h"
#include "core/numbers/address_space.h"
#include "core/result/guarded_read.h"
#include "core/result/result_reader.h"
#include "core/result/run_state_file.h"
#include "core/result/version.h"
#include "core/run/interrupt.h"
#include "core/run/run_merger.h"

namespace flatspeckle {

namespace {

/// Returns the CRC-32 of all bytes of a file; 0 if it cannot be read.
std::uint32_t file_checksum(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 1 << 16> part;
  uLong checksum = 0;
  do {
    file.read(part.data(), part.size());
    checksum = crc32_z(checksum, reinterpret_cast<const unsigned char*>(part.data()),
                       static_cast<z_size_t>(file.gcount()));
  } while (file);
  return static_cast<std::uint32_t>(checksum);
}

}  // namespace

std::string first_difference(const std::string& there, const std::string& here) {
  std::istringstream ours(here), lines(there);
  std::set<std::string> known;
  for (std::string line; std::getline(ours, line);) known.insert(line);
  for (std::string line; std::getline(lines, line);)
    if (!known.contains(line)) return line;
  return "fewer keys";
}

std::string inputs_text(const Keys& keys) {
  std::string text;
  for (const std::string& path : keys.files())
    text += path + ' ' + std::to_string(file_checksum(path)) + '\n';
  return text;
}

namespace {

// bytes; states up to this size are always stored in the result
constexpr std::size_t small_state = 16'000'000;

std::string state_group(const std::string& run) {
  return "state/" + (run.empty() ? "run" : run);
}

/// Prints a note if a run has few placements of scatterers because of its time limit. If the user
/// has set the number of placements, no note is printed.
void report_few_placements(const PlannedRun& run, std::uint64_t placements) {
  if (run.job.samples_per_batch == 1 && run.stop.seconds && placements < trusted_batches)
    std::cerr << "note: " << run.label << " has only " << placements
              << " placements: the errors are rough estimates, because fewer than "
              << trusted_batches << " placements may miss rare strong ones\n";
}

void report_few_batches(const std::string& label, std::uint64_t batches) {
  // with 9 degrees of freedom, Student's t is beyond +- 2 with a probability of 7.7 %
  constexpr std::uint64_t enough = 10;
  if (batches < enough)
    std::cerr << "note: " << label << " has only " << batches
              << " batches to estimate errors from: 2 standard errors cover less than 95 %\n";
}

void report_nothing_found(const std::string& label) {
  std::cerr << "note: all batches of " << label
            << " are equal: the sampled light contributes to none of the requested quantities, and "
               "standard errors of 0 are meaningless\n";
}

double largest_error(const std::map<std::string, RunState>& states) {
  double largest = 0;
  for (const auto& [name, state] : states)
    if (!state.trace.relative_error.empty())
      largest = std::max(largest, state.trace.relative_error.back());
  return largest;
}

void report_rare(const std::vector<std::string>& estimates) {
  if (estimates.empty()) return;
  constexpr std::size_t most = 5;
  std::cerr << "note: undersampled, with rough errors that a few strong samples dominate: ";
  for (std::size_t i = 0; i < std::min(most, estimates.size()); ++i)
    std::cerr << (i == 0 ? "" : ", ") << estimates[i];
  if (estimates.size() > most) std::cerr << " and " << estimates.size() - most << " more";
  std::cerr << " (entries with NAME_rare = 1; a longer run is needed)\n";
}

/// Prints the invariants of the result, with their limits.
void print_invariants(const ResultFile& file) {
  for (const auto& [name, worst] : file.invariants())
    std::cout << name << ": off by " << worst.off << ", at most " << worst.limit << " allowed"
              << (worst.holds() ? "" : ": FAILS, the result has not converged") << '\n';
}

void report_undefined(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    std::cerr << "note: " << name << " is left out, because one of its values is not finite\n";
}

}  // namespace

Session::Session(std::string command_line, const Keys& keys, const RunSettings& settings,
                 bool only_prints, Out kind)
    : command_line_(std::move(command_line)),
      keys_(keys),
      settings_(settings),
      seed_(keys.find("seed") ? seed_of(keys, settings) : 0),
      started_(utc_now()) {
  keys.read(settings.out);
  require_address_space_of_threads(threads());
  if (keys.find("threads")) omp_set_num_threads(threads());
  keys.read(settings.resume);
  keys.read(settings.keep_state);
  if (only_prints) return;
  if (settings.out.empty())
    throw InputError("out is not given: name the " +
                     std::string(kind == Out::result ? "result file (--out FILE.h5)"
                                                     : "placement file (--out FILE.csv)"));
  settings.resume || kind == Out::other ? check_writable(settings.out)
                                        : check_result_path(settings.out);
  if (kind != Out::shared) lock_ = std::make_unique<const OutputLock>(settings.out);
}

int Session::threads() const {
  return keys_.find("threads") ? threads_of(keys_, settings_) : 1;
}

Provenance Session::provenance() const {
  Provenance provenance;
  provenance.command_line = command_line_;
  provenance.config = keys_.config();
  provenance.seed = seed_;
  provenance.threads = threads();
  provenance.started = started_;
  return provenance;
}

void Session::commit(ResultFile& file, const Provenance& provenance) {
  write_provenance(file, provenance);
  const DelayedTermination whole;
  file.commit_checksummed(Durable::yes);
  ignore_termination_signals();
  report_rare(file.rare());
  report_undefined(file.undefined());
  std::cout << "wrote " << file.path().string() << '\n';
}

int Session::once(ResultFile file, const std::function<Made(ResultFile&)>& make) const try {
  const Made made = make(file);
  Provenance provenance = this->provenance();
  provenance.plan = made.plan;
  provenance.samples = made.samples;
  provenance.wall_s = clock_.seconds();
  provenance.cpu_s = process_cpu_seconds() - cpu_before_;
  const bool holds = file.keeps_invariants() && file.undefined().empty();
  provenance.converged = holds && made.status == ExitStatus::done;
  print_invariants(file);
  commit(file, provenance);
  return made.status == ExitStatus::done && !holds ? ExitStatus::error_not_reached : made.status;
} catch (const Interrupted&) {
  return ExitStatus::interrupted_for_good;
}

bool Session::is_complete(const std::string& identity, bool has_begun) const {
  const std::string& path = settings_.out;
  if (!settings_.resume || !std::filesystem::exists(path)) return false;
  if (!is_checksummed(path)) {
    if (has_begun) return false;
    throw InputError("resume: " + path + " is damaged, or contains another run; name another file");
  }
  const ResultReader file(path);
  const bool is_same = file.has_attribute("/", "identity") &&
                       file.attribute<std::string>("/", "identity") == identity;
  if (!is_same && !has_begun)
    throw InputError("resume: " + path + " contains another run; name another result file");
  if (!is_same || !file.attribute<bool>("/", "complete")) return false;
  std::cout << path << " is complete; nothing to resume\n";
  return true;
}

std::string Session::identity_of(const std::string& inputs) const {
  return "flatspeckle " + version() + '\n' + keys_.identity() + inputs;
}

/// Damaged files are rejected by their checksum, because HDF5 may crash on them.
void Session::require_same_run(const std::string& inputs) const {
  const std::string& path = settings_.out;
  if (!settings_.resume || !stamp_of(path)) return;
  if (!is_checksummed(path))
    throw InputError("resume: " + path + " is damaged, or never contained a run of this program");
  const ResultReader file(path);
  const auto found = file.has_attribute("/", "identity")
                         ? file.attribute<std::string>("/", "identity")
                         : std::string();
  if (const std::string wanted = identity_of(inputs); found != wanted)
    throw InputError("resume: " + path + " contains another run (" +
                     first_difference(found, wanted) +
                     "); scene, sensors, seed and program version must be the same");
}

/// Reads the states of all runs from the output file: each later version of the file must contain
/// all of them.
void Session::resume() {
  const ResultReader file(settings_.out);
  const bool ended = file.attribute<bool>("/", "converged");
  already_complete_ = ended && !extends(file);
  if (already_complete_) return;
  for (const auto& [name, label, job, stop] : runs_)
    if (const std::string group = state_group(name); file.has(group))
      states_[name] = read_state(file, group, job.size);
  has_older_ = ended && !file.has("state");
  if (has_older_)
    std::cerr << "note: " << settings_.out
              << " does not contain the sums from which it could be extended (keep_state); "
              << "the run starts again\n";
}

/// Prints a note if the output file contains a part of this run that could be resumed but will be
/// replaced.
void Session::report_unfinished() const {
  if (!is_checksummed(settings_.out)) return;
  const ResultReader file(settings_.out);
  if (!file.has_attribute("/", "identity") || file.attribute<bool>("/", "converged")) return;
  if (file.attribute<std::string>("/", "identity") == identity_)
    std::cerr << "note: " << settings_.out
              << " contains a part of this run, which starts again; --resume would continue it\n";
}

/// Whether this call requires more samples or a smaller error than the finished runs in the file
/// have.
bool Session::extends(const ResultReader& file) const {
  return std::ranges::any_of(runs_, [&](const PlannedRun& run) {
    return requires_more(run.stop, run.job, read_trace(file, run.name));
  });
}

int Session::run(std::string plan, std::vector<PlannedRun> runs, const std::string& inputs,
                 const std::function<void(ResultFile&)>& contents) {
  catch_interrupts();
  plan_ = std::move(plan);
  runs_ = std::move(runs);
  identity_ = identity_of(inputs);
  for (const auto& run : runs_) states_[run.name];
  known_ = stamp_of(settings_.out);
  const bool exists = known_.has_value();
  has_older_ = exists && !settings_.resume;
  require_same_run(inputs);
  if (exists && settings_.resume) resume();
  if (has_older_) report_unfinished();
  if (already_complete_) {
    std::cout << settings_.out << " is complete; this call requests no more\n";
    return ExitStatus::done;
  }
  std::cout << plan_ << '\n' << std::flush;
  for (const auto& run : runs_)
    if (!interrupted_) run_one(run);
  try {
    return finish(contents);
  } catch (const Interrupted&) {  // a signal arrived while the result was computed from the sums
    interrupted_ = true;
    return finish(contents);
  }
}

/// Prints a note if far more samples than requested are computed, because they are rounded up to
/// whole batches, at least two.
void Session::note_rounding(const PlannedRun& run) {
  if (!run.stop.samples) return;
  const double requested = static_cast<double>(*run.stop.samples),
               batch = run.job.samples_per_batch;
  const double done = batch * std::max(2.0, std::ceil(requested / batch));
  if (done > 1.5 * requested)
    std::cerr << "note: " << run.label << " takes " << done << " samples instead of the requested "
              << requested << ": they come in batches of " << batch << ", at least two\n";
}

void Session::run_one(const PlannedRun& run) {
  note_rounding(run);
  RunState& state = states_[run.name];
  const RunOptions options{run.stop, threads(), run.label,
                           [this](const RunState&) { save_resumable(); }};
  const StopReason reason = run_batches(run.job, options, state);
  interrupted_ = reason == StopReason::interrupted;
  if (interrupted_) {  // the run may have been interrupted before its first batch
    converged_ = false;
    return;
  }
  if (!run.job.one_by_one) {
    report_few_batches(run.label, state.sums.batches());
    report_few_placements(run, state.sums.batches());
  }
  if (found_nothing(run.job, state.sums)) {
    report_nothing_found(run.label);
    blind_ = true;
  }
  const bool reached = !run.stop.target_error || reason == StopReason::target_error ||
                       state.trace.relative_error.back() <= *run.stop.target_error;
  converged_ = converged_ && reached && !blind_;
}

int Session::finish(const std::function<void(ResultFile&)>& contents) {
  if (interrupted_) {
    save_resumable();
    std::cout << "interrupted; " << settings_.out
              << " contains the finished part; continue with --resume";
    if (!older_backup_.empty()) std::cout << "; the previous file is now " << older_backup_;
    std::cout << '\n';
    return ExitStatus::interrupted_resumable;
  }
  ResultFile file(settings_.out);
  for (const auto& [name, state] : states_) write_trace(file, name, state.trace);
  contents(file);
  const bool holds = file.keeps_invariants() && file.undefined().empty(),
             reached = std::exchange(converged_, converged_ && holds);
  write_common(file, converged_);
  print_invariants(file);
  const bool keeps_state = !converged_ || settings_.keep_state || state_bytes() <= small_state;
  if (keeps_state) write_states(file);
  back_up_foreign_files();
  file.commit_checksummed(Durable::yes);
  report_rare(file.rare());
  report_undefined(file.undefined());
  std::error_code none;
  if (!older_backup_.empty()) std::filesystem::remove(older_backup_, none);
  std::cout << "wrote " << settings_.out;
  if (!keeps_state)
    std::cout << " without the " << std::ceil(1e-6 * static_cast<double>(state_bytes()))
              << " MB of sums from which it could be extended (--keep_state keeps them)";
  std::cout << '\n';
  if (converged_) return ExitStatus::done;
  const auto is_deterministic = [](const PlannedRun& run) { return run.job.one_by_one; };
  if (!reached && std::ranges::all_of(runs_, is_deterministic))
    std::printf("not converged: the error, %.2g, exceeds the tolerance\n", largest_error(states_));
  else if (!reached)
    std::cout << (blind_ ? "not converged: no error can be estimated from equal batches; continue "
                           "with --resume\n"
                         : "stopped before the target error was reached; continue with --resume\n");
  return ExitStatus::error_not_reached;
}

void Session::write_common(ResultFile& file, bool converged) const {
  Provenance provenance = this->provenance();
  provenance.plan = plan_;
  for (const auto& [name, state] : states_) {
    provenance.wall_s += state.wall_s;
    provenance.cpu_s += state.cpu_s;
    provenance.samples += state.sums.total_samples();
  }
  provenance.converged = converged;
  provenance.identity = identity_;
  write_provenance(file, provenance);
}

void Session::back_up_older() {
  older_backup_ = back_up(settings_.out).string();
  has_older_ = false;
}

void Session::save_resumable() {
  ResultFile file(settings_.out);
  write_common(file, false);
  write_states(file);
  back_up_foreign_files();
  if (has_older_) back_up_older();
  file.commit_checksummed(Durable::yes);
  known_ = stamp_of(settings_.out);
}

/// Backs up the output file if another program has written it since this session last wrote it.
/// (Other processes of flatspeckle cannot write it because of OutputLock.)
void Session::back_up_foreign_files() {
  const auto found = stamp_of(settings_.out);
  if (!found || found == known_) return;
  const auto place = back_up(settings_.out);
  std::cerr << "warning: found a foreign file at " << settings_.out << "; it has been renamed to "
            << place.string() << '\n';
  has_older_ = false;
}

void Session::write_states(ResultFile& file) const {
  for (const auto& [name, state] : states_)
    if (state.sums.batches() > 0) write_state(file, state_group(name), state);
}

std::size_t Session::state_bytes() const {
  std::size_t sums = 0;
  for (const auto& [name, state] : states_) sums += state.sums.groups() * state.sums.size();
  return sums * sizeof(Complex);
}

}  // namespace flatspeckle
