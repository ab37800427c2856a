#include "core/run/interrupt.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <unistd.h>

namespace flatspeckle {

namespace {

std::atomic<bool> signal_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free);

struct FileToRemove {
  std::atomic<bool> taken{false};
  /// True if `name` is complete, so that the signal handler may use it.
  std::atomic<bool> whole{false};
  std::array<char, 4096> name{};
};
// needed for a lock file and a file that is being written; two more are spare
std::array<FileToRemove, 4> files_to_remove;

std::atomic<int> ending_later{0};
std::atomic<bool> end_asked{false}, termination_ignored{false};

void end_at_once(int /*signal*/) {
  if (termination_ignored) return;
  end_asked = true;
  if (ending_later > 0) return;
  for (const FileToRemove& file : files_to_remove)
    if (file.whole) ::unlink(file.name.data());
  std::_Exit(130);
}

void on_signal(int signal) {
  signal_seen = true;
  // not for SIGXCPU, which is sent again every second
  if (signal != SIGXCPU) std::signal(signal, SIG_DFL);
}

void handle_termination_signals(void (*handle)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU}) std::signal(signal, handle);
  // a program started by nohup continues to ignore SIGHUP
  if (std::signal(SIGHUP, handle) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

}  // namespace

void set_signals() {
  handle_termination_signals(end_at_once);
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGUSR1}) std::signal(signal, SIG_IGN);
}

void catch_interrupts() {
  handle_termination_signals(on_signal);
  std::signal(SIGUSR1, on_signal);
}

RemovedIfEnded::RemovedIfEnded(const std::string& path) : place_(0) {
  while (place_ < files_to_remove.size() && files_to_remove[place_].taken.exchange(true)) ++place_;
  if (place_ == files_to_remove.size() || path.size() >= files_to_remove[place_].name.size())
    return;
  std::copy_n(path.c_str(), path.size() + 1, files_to_remove[place_].name.begin());
  files_to_remove[place_].whole = true;
}

RemovedIfEnded::~RemovedIfEnded() {
  if (place_ == files_to_remove.size()) return;
  files_to_remove[place_].whole = false;
  files_to_remove[place_].taken = false;
}

DelayedTermination::DelayedTermination() {
  ++ending_later;
}

DelayedTermination::~DelayedTermination() {
  if (--ending_later == 0 && end_asked) end_at_once(SIGTERM);
}

void ignore_termination_signals() {
  termination_ignored = true;
}

bool interrupted() {
  return signal_seen;
}

}  // namespace flatspeckle
