# Which programs test which room; `tests/run ROOM` builds and runs them.
#
# The target tests-core-tree builds the programs of core/tree, tests-core those of all rooms of core. rooms.txt in the
# build folder has a line "ROOM TEST" for each. TEST is a program, or a system test if it contains a dot.

set_property(GLOBAL PROPERTY latvox_rooms "")

# Building the tests of ROOM, or of a folder that contains it, builds the further arguments.
function(latvox_build_for_room ROOM)
  while(ROOM)
    string(REPLACE "/" "-" target tests-${ROOM})
    if(NOT TARGET ${target})
      add_custom_target(${target})
    endif()
    add_dependencies(${target} ${ARGN})
    get_filename_component(ROOM "${ROOM}" DIRECTORY)
  endwhile()
endfunction()

# PROGRAMS test ROOM. Those that are not built are skipped.
function(latvox_test_room ROOM)
  foreach(program ${ARGN})
    if(TARGET ${program})
      latvox_build_for_room(${ROOM} ${program})
      set_property(GLOBAL APPEND PROPERTY latvox_rooms "${ROOM} ${program}")
    endif()
  endforeach()
endfunction()

# ROOM has no program of its own. TESTS of whole programs test it, and start PROGRAMS.
function(latvox_test_room_from_outside ROOM)
  cmake_parse_arguments(ARG "" "" "TESTS;PROGRAMS" ${ARGN})
  foreach(program ${ARG_PROGRAMS})
    if(NOT TARGET ${program})
      return()
    endif()
  endforeach()
  latvox_build_for_room(${ROOM} ${ARG_PROGRAMS})
  foreach(test ${ARG_TESTS})
    set_property(GLOBAL APPEND PROPERTY latvox_rooms "${ROOM} ${test}")
  endforeach()
endfunction()

function(latvox_write_rooms)
  get_property(rooms GLOBAL PROPERTY latvox_rooms)
  list(SORT rooms)
  list(JOIN rooms "\n" rooms)
  file(WRITE ${PROJECT_BINARY_DIR}/rooms.txt "${rooms}\n")
endfunction()
