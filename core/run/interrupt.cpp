#include "core/run/interrupt.h"

#include <atomic>
#include <csignal>

namespace flatspeckle {

namespace {

std::atomic<bool> signal_seen{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int signal) {
  signal_seen = true;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

bool interrupted() {
  return signal_seen;
}

}  // namespace flatspeckle
