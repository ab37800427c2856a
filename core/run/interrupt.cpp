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

std::array<char, 4096> doomed{};

void end_at_once(int /*signal*/) {
  if (doomed[0] != 0) ::unlink(doomed.data());
  std::_Exit(130);
}

void on_signal(int signal) {
  signal_seen = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void set_signals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, end_at_once);
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

void remove_if_ended(const std::string& path) {
  doomed[0] = 0;  // first off, last on: a signal finds it whole or not at all
  if (path.empty() || path.size() >= doomed.size()) return;
  std::copy(path.begin() + 1, path.end(), doomed.begin() + 1);
  doomed[path.size()] = 0;
  doomed[0] = path[0];
}

bool interrupted() {
  return signal_seen;
}

}  // namespace flatspeckle
