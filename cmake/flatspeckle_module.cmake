# flatspeckle_module(NAME SOURCES file... [LINK target...] [PRIVATE_LINK target...])
# Defines one module: a static library of the files in this folder with the alias flatspeckle::NAME. Its headers are
# included by their path in the project. A module may include only the modules named by LINK
# (tests/verify/test_modules.py).
function(flatspeckle_module name)
  cmake_parse_arguments(module "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  set(target flatspeckle_${name})
  add_library(${target} STATIC ${module_SOURCES})
  add_library(flatspeckle::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/flatspeckle>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${module_LINK} PRIVATE ${module_PRIVATE_LINK})
  # If a module and a program both contain a function, the linker takes the first: the module's, which is compiled with
  # full optimisation.
  target_link_options(${target} INTERFACE
    $<BUILD_INTERFACE:LINKER:--whole-archive,$<TARGET_FILE:${target}>,--no-whole-archive>)
  flatspeckle_flags(${target})
  flatspeckle_unity(${target})
  install(TARGETS ${target} EXPORT flatspeckle ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flatspeckle/${folder} FILES_MATCHING PATTERN "*.h")
endfunction()

# flatspeckle_modules(NAME module...) defines flatspeckle::NAME, which links several modules and their dependencies.
function(flatspeckle_modules name)
  add_library(flatspeckle_${name} INTERFACE)
  add_library(flatspeckle::${name} ALIAS flatspeckle_${name})
  set_target_properties(flatspeckle_${name} PROPERTIES EXPORT_NAME ${name})
  foreach(module ${ARGN})
    target_link_libraries(flatspeckle_${name} INTERFACE flatspeckle::${module})
  endforeach()
  install(TARGETS flatspeckle_${name} EXPORT flatspeckle)
endfunction()

# Makes a target use the precompiled header of another module and its compile options. With other options the compiler
# would reject the header. gcc also takes the optimisation level from the header: -O2 in core, -O3 in grin_media,
# which makes ray and path loops up to a third faster.
function(flatspeckle_share_headers name owner)
  get_target_property(options flatspeckle_${owner} COMPILE_OPTIONS)
  set_target_properties(flatspeckle_${name} PROPERTIES COMPILE_OPTIONS "${options}" POSITION_INDEPENDENT_CODE ON)
  target_precompile_headers(flatspeckle_${name} REUSE_FROM flatspeckle_${owner})
endfunction()

# Headers included by code that traces rays; they are precompiled for the program and the tests.
set(flatspeckle_ray_headers
  <core/run/runner.h> <grin/media/fields/any_index_field.h> <grin/media/scattering/scattering_medium.h>
  <grin/rays/connections/connection.h> <grin/rays/marching/any_steps.h> <grin/rays/surfaces/level_surface.h>
  <grin/rays/surfaces/lens.h> <grin/rays/surfaces/surface_region.h> <grin/rays/surfaces/straight_crossing.h>)

# Reduces the optimisation level of a target that computes little itself, which saves 40 % of its compile time. Only a
# precompiled header with the same options can be used.
function(flatspeckle_without_loops target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# Sets warnings, instruction set and sanitizers; none of them are passed on to users of the library.
function(flatspeckle_flags target)
  # Warnings take 3 % of the compile time, so they are enabled only for developers. clang reports each loop that it does
  # not vectorise, which only costs time.
  target_compile_options(${target} PRIVATE
    $<$<CONFIG:Debug>:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>
    $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>)
  # gcc 12 warns about its own AVX-512 header. Its garbage collector starts at 1 GB instead of 128 MB: 6 % less time.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;--param=ggc-min-heapsize=1000000>)
  # The project manages threads itself. Threads of Eigen's matrix products would wait actively, which is slow when
  # other programs are running.
  target_compile_definitions(${target} PRIVATE EIGEN_DONT_PARALLELIZE)
  # errno and floating-point exceptions are not used, so that loops with square roots can be vectorised.
  target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math)
  if(FLATSPECKLE_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  if(FLATSPECKLE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${FLATSPECKLE_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${FLATSPECKLE_SANITIZE})
  endif()
endfunction()

# Compiles several files of a module together, so that their headers are parsed once. The preset dev compiles every
# file separately, so that a file that lacks an include fails to compile.
function(flatspeckle_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${FLATSPECKLE_UNITY} UNITY_BUILD_BATCH_SIZE 30)
  if(FLATSPECKLE_UNITY)  # clang would warn that names of one file shadow another's
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
endfunction()
