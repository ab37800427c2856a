# flatspeckle_room(NAME SOURCES file... [LINK target...] [PRIVATE_LINK target...])
# One module: a static library with the alias flatspeckle::NAME of the files in this folder, whose headers are
# included by their path in the project. Modules include each other only as LINK says (tests/verify/test_rooms.py).
function(flatspeckle_room name)
  cmake_parse_arguments(room "" "" "SOURCES;LINK;PRIVATE_LINK" ${ARGN})
  set(target flatspeckle_${name})
  add_library(${target} STATIC ${room_SOURCES})
  add_library(flatspeckle::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/flatspeckle>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${room_LINK} PRIVATE ${room_PRIVATE_LINK})
  # Of functions that a room and a program both hold, the linker takes what it meets first: the room's, which are
  # compiled to be fast.
  target_link_options(${target} INTERFACE
    $<BUILD_INTERFACE:LINKER:--whole-archive,$<TARGET_FILE:${target}>,--no-whole-archive>)
  flatspeckle_flags(${target})
  flatspeckle_unity(${target})
  install(TARGETS ${target} EXPORT flatspeckle ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  install(DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}/
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/flatspeckle/${folder} FILES_MATCHING PATTERN "*.h")
endfunction()

# flatspeckle_rooms(NAME room...): flatspeckle::NAME stands for several modules and what these link.
function(flatspeckle_rooms name)
  add_library(flatspeckle_${name} INTERFACE)
  add_library(flatspeckle::${name} ALIAS flatspeckle_${name})
  set_target_properties(flatspeckle_${name} PROPERTIES EXPORT_NAME ${name})
  foreach(room ${ARGN})
    target_link_libraries(flatspeckle_${name} INTERFACE flatspeckle::${room})
  endforeach()
  install(TARGETS flatspeckle_${name} EXPORT flatspeckle)
endfunction()

# Compiles with the precompiled header of another module and with its options, without which it would be refused. gcc
# takes the level of optimisation, too, from the header: that of core is -O2, that of grin_media -O3, by which what
# steps along rays and paths gains up to a third.
function(flatspeckle_share_headers name owner)
  get_target_property(options flatspeckle_${owner} COMPILE_OPTIONS)
  set_target_properties(flatspeckle_${name} PROPERTIES COMPILE_OPTIONS "${options}" POSITION_INDEPENDENT_CODE ON)
  target_precompile_headers(flatspeckle_${name} REUSE_FROM flatspeckle_${owner})
endfunction()

# What those include who use rays: to be precompiled for the program and for tests.
set(flatspeckle_ray_headers
  <core/run/runner.h> <grin/media/fields/any_index_field.h> <grin/media/scattering/scattering_medium.h>
  <grin/rays/connections/connection.h> <grin/rays/marching/any_steps.h> <grin/rays/surfaces/level_surface.h>
  <grin/rays/surfaces/lens.h> <grin/rays/surfaces/room.h> <grin/rays/surfaces/straight_way.h>)

# What this target itself computes is little: it compiles in 40 % less time. Only a precompiled header of the same
# options serves it.
function(flatspeckle_without_loops target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Og>)
endfunction()

# Warnings, instruction set and sanitizers; nothing of it reaches those who link the library.
function(flatspeckle_flags target)
  # Warnings take 3 % of the compiler's time, so that those who only use the program go without. clang tells of
  # each loop that it leaves as it is, which costs time and nothing else.
  target_compile_options(${target} PRIVATE
    $<$<CONFIG:Debug>:-Wall;-Wextra;-Wpedantic;-Wshadow;-Wconversion;-Wno-sign-conversion>
    $<$<CXX_COMPILER_ID:Clang>:-Wno-pass-failed>)
  # gcc 12 warns of its own AVX-512 header. It tidies its memory when it holds a gigabyte, not time and again from
  # 128 MB on: 6 % less time.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized;--param=ggc-min-heapsize=1000000>)
  # Threads are ours: those of Eigen's products spin where they wait for each other, long beside other programs.
  target_compile_definitions(${target} PRIVATE EIGEN_DONT_PARALLELIZE)
  # Nobody asks whether a root failed: it need not set errno, nor comparisons raise flags, and loops become vectors.
  target_compile_options(${target} PRIVATE -fno-math-errno -fno-trapping-math)
  if(FLATSPECKLE_NATIVE)
    target_compile_options(${target} PRIVATE -march=native)
  endif()
  if(FLATSPECKLE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${FLATSPECKLE_SANITIZE} -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${FLATSPECKLE_SANITIZE})
  endif()
endfunction()

# Files of a room are compiled a few at a time, which parses what they include once. The preset dev
# goes without, so that a file without the includes it needs does not compile.
function(flatspeckle_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${FLATSPECKLE_UNITY} UNITY_BUILD_BATCH_SIZE 30)
  if(FLATSPECKLE_UNITY)  # clang would see names of one file shadowed by another's
    target_compile_options(${target} PRIVATE -Wno-shadow)
  endif()
endfunction()
