#pragma once

namespace flatspeckle {

/// After this, SIGINT and SIGTERM set a flag that ends runs after the batches in hand; a second
/// signal ends the program at once.
void catch_interrupts();

/// Whether a signal has come since catch_interrupts().
bool interrupted();

}  // namespace flatspeckle
