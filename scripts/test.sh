#!/usr/bin/env bash
# test.sh [--all]: installs missing packages (Debian 12), builds the release preset and runs its
# tests; with --all also the nightly ones, which take hours.
set -euo pipefail
case "$*" in
  "") preset=release ;;
  --all) preset=all ;;
  *) echo "usage: scripts/test.sh [--all]" >&2; exit 2 ;;
esac
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_build_packages
install_test_packages
build_release all -DFLATSPECKLE_TESTS=ON "-DFLATSPECKLE_MPI=$(has_mpi && echo ON || echo OFF)"
ctest --preset "$preset" --parallel "$jobs"
echo "All tests passed in $SECONDS s."
