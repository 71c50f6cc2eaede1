# find_package(belvedere CONFIG) from Belvedere's source tree: defines the target belvedere::belvedere.
#
#   BELVEDERE_ROOT         the source tree; this file's own by default
#   BELVEDERE_LIBRARY_DIR  where libbelvedere_bridge is; by default where cargo puts release builds
#   BELVEDERE_SHARED       link the shared library instead of the static one
#
# If the library does not exist, it is built with cargo.
cmake_minimum_required(VERSION 3.16)

get_filename_component(_belvedere_default_root "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(BELVEDERE_ROOT "${_belvedere_default_root}" CACHE PATH "Belvedere's source tree")
option(BELVEDERE_SHARED "Link Belvedere's shared library" OFF)
if(DEFINED ENV{CARGO_TARGET_DIR})
  set(_belvedere_target "$ENV{CARGO_TARGET_DIR}")
else()
  set(_belvedere_target "${BELVEDERE_ROOT}/target")
endif()
set(BELVEDERE_LIBRARY_DIR "${_belvedere_target}/release" CACHE PATH "Where libbelvedere_bridge is")

if(BELVEDERE_SHARED)
  set(_belvedere_file "${CMAKE_SHARED_LIBRARY_PREFIX}belvedere_bridge${CMAKE_SHARED_LIBRARY_SUFFIX}")
else()
  set(_belvedere_file "${CMAKE_STATIC_LIBRARY_PREFIX}belvedere_bridge${CMAKE_STATIC_LIBRARY_SUFFIX}")
endif()
set(_belvedere_library "${BELVEDERE_LIBRARY_DIR}/${_belvedere_file}")

if(NOT EXISTS "${_belvedere_library}")
  find_program(CARGO cargo HINTS "$ENV{CARGO_HOME}/bin" "$ENV{HOME}/.cargo/bin")
  if(CARGO)
    message(STATUS "Building ${_belvedere_library} with cargo")
    execute_process(
      COMMAND "${CARGO}" build --release -p belvedere-bridge-c
      WORKING_DIRECTORY "${BELVEDERE_ROOT}"
      RESULT_VARIABLE _belvedere_failed)
  endif()
  if(NOT EXISTS "${_belvedere_library}")
    set(belvedere_FOUND FALSE)
    set(belvedere_NOT_FOUND_MESSAGE
      "${_belvedere_library} is missing: run `cargo build --release -p belvedere-bridge-c` in ${BELVEDERE_ROOT}, \
or say where it is with -DBELVEDERE_LIBRARY_DIR=...")
    return()
  endif()
endif()

if(NOT TARGET belvedere::belvedere)
  if(BELVEDERE_SHARED)
    add_library(belvedere::belvedere SHARED IMPORTED)
    # cargo sets no soname: link by name, to be found in the run path, not by the current path.
    set_target_properties(belvedere::belvedere PROPERTIES IMPORTED_NO_SONAME TRUE)
  else()
    find_package(Threads REQUIRED)
    add_library(belvedere::belvedere STATIC IMPORTED)
    set_target_properties(belvedere::belvedere PROPERTIES
      INTERFACE_LINK_LIBRARIES "Threads::Threads;${CMAKE_DL_LIBS};m;rt")
  endif()
  set_target_properties(belvedere::belvedere PROPERTIES
    IMPORTED_LOCATION "${_belvedere_library}"
    INTERFACE_INCLUDE_DIRECTORIES "${BELVEDERE_ROOT}/bridge/c/include;${BELVEDERE_ROOT}/bridge/cpp/include")
endif()
set(belvedere_FOUND TRUE)
