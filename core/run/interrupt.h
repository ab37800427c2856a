#pragma once

namespace flatspeckle {

/// After this, SIGINT and SIGTERM set a flag that ends runs after the batches in hand; a second
/// signal ends the program at once.
void catch_interrupts();

/// Whether a signal has come since catch_interrupts().
bool interrupted();

/// What a long batch throws where it stops half-way, for a signal has come: that batch is lost.
struct Interrupted {};
inline void stop_if_interrupted() {
  if (interrupted()) throw Interrupted{};
}

}  // namespace flatspeckle
