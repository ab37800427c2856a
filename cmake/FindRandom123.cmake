# Finds Random123 (headers only; Debian: librandom123-dev) and defines Random123::Random123. Set Random123_INCLUDE_DIR
# if it is not found automatically.
find_path(Random123_INCLUDE_DIR Random123/threefry.h)
mark_as_advanced(Random123_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Random123 REQUIRED_VARS Random123_INCLUDE_DIR)

if(Random123_FOUND AND NOT TARGET Random123::Random123)
  add_library(Random123::Random123 INTERFACE IMPORTED)
  target_include_directories(Random123::Random123 INTERFACE ${Random123_INCLUDE_DIR})
endif()
