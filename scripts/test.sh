#!/usr/bin/env bash
# Installs what is missing (Debian 12), builds the release preset and runs its tests.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_build_packages
install_test_packages
build_release all -DFLATSPECKLE_TESTS=ON "-DFLATSPECKLE_MPI=$(has_mpi && echo ON || echo OFF)"
ctest --preset release --parallel "$jobs"
echo "All tests passed in $SECONDS s."
