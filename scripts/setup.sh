# shellcheck shell=bash Sourced by the other scripts. Changes to the root of the checkout, and defines functions that
# install packages and build.
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

jobs=$(nproc)
# Prefers Debian's own tools, because another Python would not find the packages installed here.
PATH=/usr/bin:$PATH

as_root() {
  if [[ $EUID -eq 0 ]]; then "$@"; else sudo "$@"; fi
}

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Abbrev}' "$1" 2>/dev/null) == ii* ]]
}

# install_missing PACKAGE...: installs missing packages on Debian; elsewhere it only lists them.
install_missing() {
  if ! command -v apt-get dpkg-query >/dev/null; then
    echo "Not Debian: install these packages yourself (Debian names): $*"
    return
  fi
  local package missing=()
  for package in "$@"; do
    is_installed "$package" || missing+=("$package")
  done
  [[ ${#missing[@]} -gt 0 ]] || return 0
  echo "Installing ${missing[*]}"
  as_root apt-get --quiet update
  as_root env DEBIAN_FRONTEND=noninteractive apt-get --quiet --yes --no-install-recommends \
    install "${missing[@]}"
}

# Packages for the program alone.
install_build_packages() {
  install_missing g++ cmake ninja-build pkg-config libhdf5-dev liblapacke-dev libopenblas-dev \
    libfftw3-dev libnlopt-dev libpng-dev libtiff-dev libeigen3-dev libcli11-dev librandom123-dev libtomlplusplus-dev \
    nlohmann-json3-dev
}

# Packages for the subcommand bench.
install_bench_packages() {
  install_missing libboost-dev
}

# Packages for the tests; MPI, xarray and plots are tested only if installed.
install_test_packages() {
  install_bench_packages
  install_plot_packages
  install_missing doctest-dev python3-h5py libopenmpi-dev openmpi-bin python3-xarray \
    python3-h5netcdf
}

has_mpi() {
  command -v mpicxx >/dev/null && command -v mpirun >/dev/null
}

install_plot_packages() {
  install_missing python3-h5py python3-matplotlib
}

# build_release TARGET OPTION...: builds in build/release.
build_release() {
  cmake --preset release "${@:2}"
  cmake --build --preset release --parallel "$jobs" --target "$1"
}
