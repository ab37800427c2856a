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

struct Doomed {
  std::atomic<bool> taken{false};
  std::atomic<bool> whole{false};  ///< the name, for a signal handler
  std::array<char, 4096> name{};
};
std::array<Doomed, 4> doomed;  // a lock, a file being written, and to spare

std::atomic<int> ending_later{0};
std::atomic<bool> end_asked{false}, result_there{false};

void end_at_once(int /*signal*/) {
  if (result_there) return;
  end_asked = true;
  if (ending_later > 0) return;
  for (const Doomed& file : doomed)
    if (file.whole) ::unlink(file.name.data());
  std::_Exit(130);
}

void on_signal(int signal) {
  signal_seen = true;
  if (signal != SIGXCPU) std::signal(signal, SIG_DFL);  // which comes every second from then on
}

void handle_ends(void (*handle)(int)) {
  for (const int signal : {SIGINT, SIGTERM, SIGXCPU}) std::signal(signal, handle);
  if (std::signal(SIGHUP, handle) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // nohup
}

}  // namespace

void set_signals() {
  handle_ends(end_at_once);
  for (const int signal : {SIGPIPE, SIGXFSZ, SIGUSR1}) std::signal(signal, SIG_IGN);
}

void catch_interrupts() {
  handle_ends(on_signal);
  std::signal(SIGUSR1, on_signal);
}

RemovedIfEnded::RemovedIfEnded(const std::string& path) : place_(0) {
  while (place_ < doomed.size() && doomed[place_].taken.exchange(true)) ++place_;
  if (place_ == doomed.size() || path.size() >= doomed[place_].name.size()) return;
  std::copy_n(path.c_str(), path.size() + 1, doomed[place_].name.begin());
  doomed[place_].whole = true;
}

RemovedIfEnded::~RemovedIfEnded() {
  if (place_ == doomed.size()) return;
  doomed[place_].whole = false;
  doomed[place_].taken = false;
}

EndsLater::EndsLater() {
  ++ending_later;
}

EndsLater::~EndsLater() {
  if (--ending_later == 0 && end_asked) end_at_once(SIGTERM);
}

void result_is_there() {
  result_there = true;
}

bool interrupted() {
  return signal_seen;
}

}  // namespace flatspeckle
