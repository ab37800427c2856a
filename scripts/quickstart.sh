#!/usr/bin/env bash
# quickstart.sh [FOLDER]: installs missing packages (Debian 12), builds the program, and runs it on
# shipped data and scenes (first_results.sh). Results and plots go to FOLDER, by default results/ in
# the checkout.
set -euo pipefail
results=${1:+$(realpath -m "$1")}
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"
results=${results:-results}

install_build_packages
install_plot_packages
build_release flatspeckle -DFLATSPECKLE_TESTS=OFF -DFLATSPECKLE_BENCH=OFF
scripts/first_results.sh build/release/bin/flatspeckle "$results"
printf '\n== Done in %s s; in %s:\n' "$SECONDS" "$results"
ls "$results" "$results/ten_disks"
