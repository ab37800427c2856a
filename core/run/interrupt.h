#pragma once

#include <cstddef>
#include <string>

namespace flatspeckle {

/// After this, SIGINT, SIGTERM, SIGHUP and SIGXCPU (processor time runs out) end the program at
/// once with exit status 130, and neither a closed pipe nor a limit on the size of files ends it:
/// writing fails. SIGUSR1, by which batch systems warn before they end a program, is ignored.
void set_signals();

/// After this, SIGINT, SIGTERM, SIGHUP, SIGXCPU and SIGUSR1 set a flag that ends runs after the
/// batches in hand; a second signal ends the program at once, but SIGXCPU.
void catch_interrupts();

/// A file that is removed, too, where the program ends with 130 while this lives.
class RemovedIfEnded {
 public:
  explicit RemovedIfEnded(const std::string& path);
  RemovedIfEnded(const RemovedIfEnded&) = delete;
  RemovedIfEnded& operator=(const RemovedIfEnded&) = delete;
  ~RemovedIfEnded();

 private:
  std::size_t place_;
};

/// While one lives, the end at once waits: what is on the disk and what RemovedIfEnded knows of it
/// change together.
class EndsLater {
 public:
  EndsLater();
  EndsLater(const EndsLater&) = delete;
  EndsLater& operator=(const EndsLater&) = delete;
  ~EndsLater();
};

/// After this no signal ends the program at once: its result is there, and the end near.
void result_is_there();

/// Whether a signal has come since catch_interrupts().
bool interrupted();

/// What a long batch throws where it stops half-way, for a signal has come: that batch is lost.
struct Interrupted {};
inline void stop_if_interrupted() {
  if (interrupted()) throw Interrupted{};
}

}  // namespace flatspeckle
