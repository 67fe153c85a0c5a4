# The core's tests: units, and the two exact tiers (scalar = oracle, pipeline = oracle).

# Choose the kernels that a program runs on.
add_library(latvox_core_main OBJECT unit/core_main.cc)
target_link_libraries(latvox_core_main PRIVATE latvox_build latvox::core latvox_oracle GTest::gmock)
target_precompile_headers(
  latvox_core_main PRIVATE
  <algorithm> <array> <atomic> <cmath> <functional> <map> <memory> <optional> <random> <set> <span> <string> <utility>
  <vector>
  <absl/container/flat_hash_map.h> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/strings/str_format.h>
  <gmock/gmock.h> <gmpxx.h> <gtest/gtest.h>)

# Adds the program NAME from unit/NAME.cc, with further arguments of latvox_add_test.
function(latvox_add_core_test NAME)
  latvox_add_test(${NAME} SOURCES unit/${NAME}.cc LIBRARIES latvox::core latvox_oracle latvox_core_main ${ARGN})
endfunction()

latvox_add_core_test(core_lattice_test)
latvox_add_core_test(core_huge_pages_test)
latvox_add_core_test(core_scan_pool_test THREADED)
latvox_add_core_test(core_snap_test THREADED)
latvox_add_core_test(core_surface_facts_test THREADED)
latvox_add_core_test(core_tile_tree_test THREADED)
latvox_add_core_test(core_crossing_test UNSANITIZED)
# Promises of time, which sanitizers do not keep.
latvox_add_core_test(core_cancel_test UNSANITIZED)
latvox_add_core_test(core_voxelizer_test THREADED)
latvox_add_core_test(core_parts_test THREADED)
latvox_add_core_test(core_fine_test THREADED)
latvox_add_core_test(core_bounds_test)
latvox_add_core_test(core_solid_test UNSANITIZED)
latvox_add_core_test(core_oracle_test SLOW)
latvox_add_core_test(core_plane_crossing_test UNSANITIZED)
latvox_add_core_test(core_plane_pixelize_test)
latvox_add_core_test(core_plane_thesis_test)
latvox_add_core_test(core_thesis_tables_test UNSANITIZED)
latvox_add_core_test(core_thesis_test UNSANITIZED)
latvox_add_core_test(core_thesis_job_test SLOW)
latvox_add_core_test(core_validate_water_test THREADED)
latvox_add_core_test(core_band_test GTest::gmock)
latvox_add_core_test(core_attributes_test GTest::gmock)
list(APPEND CMAKE_MODULE_PATH /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB)
find_package(OpenVDB REQUIRED)
latvox_add_core_test(core_band_openvdb_test latvox::grid)
latvox_add_core_test(core_principal_test)
latvox_add_core_test(core_supercover_test)
latvox_add_core_test(core_candidates_test)
latvox_add_core_test(core_line_scan_test)
latvox_add_core_test(core_row_spans_test)
if(TARGET core_row_spans_test) # compiled for the core's instruction sets
  target_compile_definitions(core_row_spans_test PRIVATE $<TARGET_PROPERTY:latvox_core,COMPILE_DEFINITIONS>)
endif()
latvox_add_core_test(core_kernel_test)
latvox_add_core_test(core_tiny_test THREADED)
latvox_add_core_test(core_threads_test THREADED)

# The programs whose results go through kernels, once more on the kernels that are not the best; see tests/README.md. Not
# the tests that go through all kernels by themselves, and two that are long and of other things.
if(NOT latvox_sanitized)
  foreach(program attributes band band_openvdb bounds parts snap solid supercover thesis_job tile_tree voxelizer)
    foreach(simd scalar avx2)
      set(name core_${program}_test.${simd})
      add_test(NAME ${name} COMMAND core_${program}_test --gtest_brief=1 --gtest_filter=-*Kernel*:*Bunny*:*CostAboutTheSame*)
      set_tests_properties(${name} PROPERTIES ENVIRONMENT LATVOX_SIMD=${simd} SKIP_RETURN_CODE 77 TIMEOUT 300 LABELS slow)
    endforeach()
  endforeach()
endif()
