# shellcheck shell=bash
# Sourced by the other scripts: goes to the root of the checkout; how to prepare a machine and build.
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit

jobs=$(nproc)
# Debian's own tools go together; another python, say, would not know the packages installed here.
PATH=/usr/bin:$PATH

as_root() {
  if [[ $EUID -eq 0 ]]; then "$@"; else sudo "$@"; fi
}

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Abbrev}' "$1" 2>/dev/null) == ii* ]]
}

# install_missing PACKAGE...: those that are not there yet, on Debian; elsewhere it only names them.
install_missing() {
  if ! command -v apt-get dpkg-query >/dev/null; then
    echo "Not Debian: nothing is installed here. Needed, by Debian's names: $*"
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

# For the program alone.
install_build_packages() {
  install_missing g++ cmake ninja-build pkg-config libhdf5-dev liblapacke-dev libopenblas-dev \
    libfftw3-dev libnlopt-dev libeigen3-dev libcli11-dev librandom123-dev libtomlplusplus-dev
}

# For the subcommand bench.
install_bench_packages() {
  install_missing libboost-dev
}

# For the tests; MPI, xarray and plots are tested where they are there.
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

# build_release TARGET OPTION...: into build/release.
build_release() {
  cmake --preset release "${@:2}"
  cmake --build --preset release --parallel "$jobs" --target "$1"
}
