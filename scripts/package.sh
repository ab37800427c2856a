#!/usr/bin/env bash
# Installs missing packages (Debian 12) and makes a Debian package for any x86-64:
# build/package/flatspeckle_*.deb.
set -euo pipefail
# shellcheck source=scripts/setup.sh
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

install_build_packages
install_missing dpkg-dev file
cmake -S . -B build/package -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake --build build/package --parallel "$jobs"
cd build/package
cpack --config CPackConfig.cmake
ls flatspeckle_*.deb
