#include "core/session/session.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
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

/// CRC-32 of all bytes of a file; 0 where it cannot be read.
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

std::filesystem::path free_aside(const std::filesystem::path& path) {
  for (int number = 1;; ++number) {
    const std::filesystem::path place = path.string() + ".aside-" + std::to_string(number);
    if (!std::filesystem::exists(place)) return place;
  }
}

std::filesystem::path set_aside(const std::filesystem::path& given) {
  namespace fs = std::filesystem;
  const fs::path path = link_target(given), place = free_aside(path);
  std::error_code failed;
  fs::create_hard_link(path, place, failed);
  if (failed) fs::rename(path, place, failed);
  if (failed) throw IoError("renaming " + path.string() + " failed: " + failed.message());
  return place;
}

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct ::stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return FileStamp{found.st_dev, found.st_ino, found.st_mtim.tv_sec, found.st_mtim.tv_nsec};
}

namespace {

namespace fs = std::filesystem;

fs::path lock_beside(const fs::path& out) {
  std::ostringstream name;
  name << '.' << out.filename().string() << ".lock";
  return out.parent_path() / name.str();
}

std::string this_process() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return std::to_string(::getpid()) + " on " + host.data();
}

std::string content(int descriptor) {
  std::array<char, 300> text{};
  const ::ssize_t length = ::pread(descriptor, text.data(), text.size() - 1, 0);
  return length > 0 ? std::string(text.data()) : std::string("that does not say its name");
}

/// For people: the lock holds without. Open no longer than that, or no disk could be made
/// read-only.
void say_owner(const fs::path& lock) {
  std::ofstream(lock) << this_process();
}

/// Not so where the process that held it has just removed it.
bool is_still_there(int descriptor, const fs::path& path) {
  struct ::stat held {};
  struct ::stat found {};
  return ::fstat(descriptor, &held) == 0 && ::stat(path.c_str(), &found) == 0 &&
         held.st_ino == found.st_ino && held.st_dev == found.st_dev;
}

constexpr std::size_t small_state = 16'000'000;  // bytes; kept whether it is asked for or not

std::string state_group(const std::string& run) {
  return "state/" + (run.empty() ? "run" : run);
}

/// Placements that a time allowed: who asks for a number knows it.
void tell_few_placements(const PlannedRun& run, std::uint64_t placements) {
  if (run.job.samples_per_batch == 1 && run.stop.seconds && placements < trusted_batches)
    std::cerr << "note: " << run.label << " has only " << placements
              << " placements: its errors are rough themselves, fewer than " << trusted_batches
              << " miss rare strong ones\n";
}

void tell_few_batches(const std::string& label, std::uint64_t batches) {
  constexpr std::uint64_t enough = 10;  // of Student's t with 9 degrees 7.7 % lie beyond 2
  if (batches < enough)
    std::cerr << "note: " << label << " has only " << batches
              << " batches to take errors from: 2 standard errors do not cover 95 %\n";
}

void tell_nothing_found(const std::string& label) {
  std::cerr
      << "note: all batches of " << label
      << " are the same: the light that it samples has reached nothing that is asked for, and "
         "standard errors of 0 are not to be trusted\n";
}

void tell_rare(const std::vector<std::string>& estimates) {
  if (estimates.empty()) return;
  constexpr std::size_t most = 5;
  std::cerr << "note: errors that rest on a few strong paths, and are rough themselves: ";
  for (std::size_t i = 0; i < std::min(most, estimates.size()); ++i)
    std::cerr << (i == 0 ? "" : ", ") << estimates[i];
  if (estimates.size() > most) std::cerr << " and " << estimates.size() - most << " more";
  std::cerr << " (NAME_rare marks them; more samples tell)\n";
}

/// Prints the invariants that the result was checked by.
void print_invariants(const ResultFile& file) {
  for (const auto& [name, worst] : file.invariants())
    std::cout << name << ": off by " << worst.off << ", at most " << worst.limit << " allowed"
              << (worst.holds() ? "" : ": FAILS, so that the result has not converged") << '\n';
}

void tell_undefined(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    std::cerr << "note: " << name << " is left out: a value of it is not finite\n";
}

}  // namespace

OutputLock::OutputLock(const std::filesystem::path& out) : path_(lock_beside(link_target(out))) {
  while (!take(out)) {
  }
  if (descriptor_ >= 0) remove_temporary_files(link_target(out));
}

/// False where it is to be tried again.
bool OutputLock::take(const std::filesystem::path& out) {
  const EndsLater whole;
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) return true;
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const bool taken = errno == EWOULDBLOCK;
    const std::string owner = content(descriptor_);
    ::close(std::exchange(descriptor_, -1));
    if (taken)
      throw InputError("out", out.string(),
                       "process " + owner + " works on it; wait for its end, or name another file");
    return true;
  }
  if (!is_still_there(descriptor_, path_)) {
    ::close(std::exchange(descriptor_, -1));
    return false;
  }
  removed_.emplace(path_.string());
  say_owner(path_);
  return true;
}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  const EndsLater whole;
  removed_.reset();
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

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
  const EndsLater whole;
  file.commit_sealed(Durable::yes);
  result_is_there();
  tell_rare(file.rare());
  tell_undefined(file.undefined());
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
  if (!is_sealed(path)) {
    if (has_begun) return false;
    throw InputError("resume: " + path + " is damaged, or holds another run; name another file");
  }
  const ResultReader file(path);
  const bool is_same = file.has_attribute("/", "identity") &&
                       file.attribute<std::string>("/", "identity") == identity;
  if (!is_same && !has_begun)
    throw InputError("resume: " + path + " holds another run; name another result file");
  if (!is_same || !file.attribute<bool>("/", "complete")) return false;
  std::cout << path << " is complete; nothing to resume\n";
  return true;
}

/// All states at once: what is saved while one run goes on must hold those of the others. HDF5,
/// which may crash on a damaged file, sees none.
void Session::resume() {
  const std::string& path = settings_.out;
  if (!is_sealed(path))
    throw InputError("resume: " + path + " is damaged, or never held a run of this program");
  const ResultReader file(path);
  const auto found = file.has_attribute("/", "identity")
                         ? file.attribute<std::string>("/", "identity")
                         : std::string();
  if (found != identity_)
    throw InputError("resume: " + path + " holds another run (" +
                     first_difference(found, identity_) +
                     "); scene, sensors, seed and program version must be the same");
  const bool ended = file.attribute<bool>("/", "converged");
  already_complete_ = ended && !extends(file);
  if (already_complete_) return;
  for (const auto& [name, label, job, stop] : runs_)
    if (const std::string group = state_group(name); file.has(group))
      states_[name] = read_state(file, group, job.size);
  has_older_ = ended && !file.has("state");
  if (has_older_)
    std::cerr << "note: " << path << " has not kept what it could be extended from (keep_state); "
              << "all is done afresh\n";
}

/// What an interrupted run has done is not thrown away without a word.
void Session::tell_unfinished() const {
  if (!is_sealed(settings_.out)) return;
  const ResultReader file(settings_.out);
  if (!file.has_attribute("/", "identity") || file.attribute<bool>("/", "converged")) return;
  if (file.attribute<std::string>("/", "identity") == identity_)
    std::cerr << "note: " << settings_.out
              << " holds a part of this run, which begins anew; --resume would go on with it\n";
}

/// Whether this call asks for more than the file holds, whose runs have ended.
bool Session::extends(const ResultReader& file) const {
  return std::ranges::any_of(runs_, [&](const PlannedRun& run) {
    return asks_more(run.stop, run.job, read_trace(file, run.name));
  });
}

int Session::run(std::string plan, std::vector<PlannedRun> runs, const std::string& inputs,
                 const std::function<void(ResultFile&)>& contents) {
  catch_interrupts();
  plan_ = std::move(plan);
  runs_ = std::move(runs);
  identity_ = "flatspeckle " + version() + '\n' + keys_.identity() + inputs;
  for (const auto& run : runs_) states_[run.name];
  known_ = stamp_of(settings_.out);
  const bool exists = known_.has_value();
  has_older_ = exists && !settings_.resume;
  if (exists && settings_.resume) resume();
  if (has_older_) tell_unfinished();
  if (already_complete_) {
    std::cout << settings_.out << " is complete, and no more is asked for\n";
    return ExitStatus::done;
  }
  std::cout << plan_ << '\n' << std::flush;
  for (const auto& run : runs_)
    if (!interrupted_) run_one(run);
  try {
    return finish(contents);
  } catch (const Interrupted&) {  // while the result was made of the sums
    interrupted_ = true;
    return finish(contents);
  }
}

/// Samples come in whole batches, two at the least: what is far more than was asked for is said.
void Session::note_rounding(const PlannedRun& run) {
  if (!run.stop.samples) return;
  const double asked = static_cast<double>(*run.stop.samples), batch = run.job.samples_per_batch;
  const double done = batch * std::max(2.0, std::ceil(asked / batch));
  if (done > 1.5 * asked)
    std::cerr << "note: " << run.label << " takes " << done << " samples for the " << asked
              << " asked for: they come in batches of " << batch << ", two at the least\n";
}

void Session::run_one(const PlannedRun& run) {
  note_rounding(run);
  RunState& state = states_[run.name];
  const RunOptions options{run.stop, threads(), run.label,
                           [this](const RunState&) { save_resumable(); }};
  const StopReason reason = run_batches(run.job, options, state);
  interrupted_ = reason == StopReason::interrupted;
  if (interrupted_) {  // perhaps before the first batch
    converged_ = false;
    return;
  }
  if (!run.job.one_by_one) {
    tell_few_batches(run.label, state.sums.batches());
    tell_few_placements(run, state.sums.batches());
  }
  if (found_nothing(run.job, state.sums)) {
    tell_nothing_found(run.label);
    blind_ = true;
  }
  const bool reached = !run.stop.target_error || reason == StopReason::target_error ||
                       state.trace.relative_error.back() <= *run.stop.target_error;
  converged_ = converged_ && reached && !blind_;
}

int Session::finish(const std::function<void(ResultFile&)>& contents) {
  if (interrupted_) {
    save_resumable();
    std::cout << "interrupted; " << settings_.out << " holds what is done, --resume goes on";
    if (!older_aside_.empty()) std::cout << "; what it held before is in " << older_aside_;
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
  set_strangers_aside();
  file.commit_sealed(Durable::yes);
  tell_rare(file.rare());
  tell_undefined(file.undefined());
  std::error_code none;
  if (!older_aside_.empty()) std::filesystem::remove(older_aside_, none);
  std::cout << "wrote " << settings_.out;
  if (!keeps_state)
    std::cout << " without the " << std::ceil(1e-6 * static_cast<double>(state_bytes()))
              << " MB of sums that extend it (--keep_state)";
  std::cout << '\n';
  if (converged_) return ExitStatus::done;
  const auto is_deterministic = [](const PlannedRun& run) { return run.job.one_by_one; };
  if (!reached)
    std::cout
        << (std::ranges::all_of(runs_, is_deterministic)
                ? "not converged: the error is more than the tolerance\n"
            : blind_ ? "not converged: no error can be taken from equal batches; --resume goes on\n"
                     : "stopped before the target error was reached; --resume goes on\n");
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

void Session::set_older_aside() {
  older_aside_ = set_aside(settings_.out).string();
  has_older_ = false;
}

void Session::save_resumable() {
  ResultFile file(settings_.out);
  write_common(file, false);
  write_states(file);
  set_strangers_aside();
  if (has_older_) set_older_aside();
  file.commit_sealed(Durable::yes);
  known_ = stamp_of(settings_.out);
}

/// What something else has put there since: this program keeps off (OutputLock).
void Session::set_strangers_aside() {
  const auto found = stamp_of(settings_.out);
  if (!found || found == known_) return;
  const auto place = set_aside(settings_.out);
  std::cerr << "warning: another file stood at " << settings_.out << "; it is now "
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
