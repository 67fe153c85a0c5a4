# The core's tests: units, and the two exact tiers (scalar = oracle, pipeline = oracle).

# Choose the kernels that a program runs on.
add_library(latvox_core_main OBJECT unit/core/main.cc)
target_link_libraries(latvox_core_main PRIVATE latvox_build latvox::core latvox_oracle GTest::gmock)
target_precompile_headers(
  latvox_core_main PRIVATE
  <algorithm> <array> <atomic> <cmath> <functional> <map> <memory> <optional> <random> <set> <span> <string> <utility>
  <vector>
  <absl/container/flat_hash_map.h> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/strings/str_format.h>
  <gmock/gmock.h> <gmpxx.h> <gtest/gtest.h>)

# Adds the program NAME from unit/core/SOURCE, with further arguments of latvox_add_test.
function(latvox_add_core_test NAME SOURCE)
  latvox_add_test(${NAME} SOURCES unit/core/${SOURCE} LIBRARIES latvox::core latvox_oracle latvox_core_main ${ARGN})
endfunction()

latvox_add_core_test(core_lattice_test lattice/lattice_test.cc)
latvox_add_core_test(core_huge_pages_test base/huge_pages_test.cc)
latvox_add_core_test(core_cpu_meter_test base/cpu_meter_test.cc THREADED)
latvox_add_core_test(core_brick_test brick/brick_test.cc)
latvox_add_core_test(core_sort_test base/sort_test.cc)
latvox_add_core_test(core_scan_pool_test block/scan_pool_test.cc THREADED)
latvox_add_core_test(core_rules_test request/rules_test.cc GTest::gmock)
if(TARGET core_rules_test)
  target_compile_definitions(core_rules_test PRIVATE LATVOX_PROTO_README="${PROJECT_SOURCE_DIR}/proto/README.md")
endif()
latvox_add_core_test(core_snap_test snap/snap_test.cc THREADED)
latvox_add_core_test(core_surface_facts_test triangles/surface_facts_test.cc THREADED)
latvox_add_core_test(core_tile_tree_test tree/tile_tree_test.cc THREADED)
latvox_add_core_test(core_crossing_test digitize/crossing_test.cc UNSANITIZED)
# Promises of time, which sanitizers do not keep.
latvox_add_core_test(core_cancel_test voxelizer/cancel_test.cc UNSANITIZED TIMED)
latvox_add_core_test(core_plane_cancel_test plane/cancel_test.cc UNSANITIZED TIMED)
latvox_add_core_test(core_thesis_cancel_test thesis/cancel_test.cc UNSANITIZED TIMED)
latvox_add_core_test(core_estimate_test voxelizer/estimate_test.cc)
# It replaces the allocator, as sanitizers do.
latvox_add_core_test(core_walk_estimate_test voxelizer/walk_estimate_test.cc UNSANITIZED)
latvox_add_core_test(core_voxelizer_test voxelizer/voxelizer_test.cc THREADED)
latvox_add_core_test(core_interrupt_test voxelizer/interrupt_test.cc THREADED)
latvox_add_core_test(core_parts_test voxelizer/parts_test.cc THREADED)
latvox_add_core_test(core_fine_test tiny/fine_test.cc THREADED)
latvox_add_core_test(core_bounds_test voxelizer/bounds_test.cc)
latvox_add_core_test(core_solid_test solid/solid_test.cc UNSANITIZED)
latvox_add_core_test(core_refused_solid_test solid/refused_test.cc UNSANITIZED)
latvox_add_core_test(core_labeled_solid_test solid/labeled_solid_test.cc THREADED)
latvox_add_core_test(core_growth_test walk/growth_test.cc)
latvox_add_core_test(core_walk_test walk/walk_test.cc)
latvox_add_core_test(core_leak_test walk/leak_test.cc)
latvox_add_core_test(core_labeled_walk_test walk/labeled_walk_test.cc)
latvox_add_core_test(core_oracle_test voxelizer/oracle_test.cc SLOW)
latvox_add_core_test(core_plane_crossing_test plane/crossing_test.cc UNSANITIZED)
latvox_add_core_test(core_plane_pixelize_test plane/pixelize_test.cc)
latvox_add_core_test(core_plane_thesis_test plane/thesis_test.cc)
latvox_add_core_test(core_thesis_tables_test thesis/thesis_tables_test.cc UNSANITIZED)
latvox_add_core_test(core_thesis_test thesis/thesis_test.cc UNSANITIZED)
latvox_add_core_test(core_thesis_job_test voxelizer/thesis_job_test.cc SLOW)
latvox_add_core_test(core_water_test verify/water_test.cc THREADED)
latvox_add_core_test(core_band_test band/band_test.cc GTest::gmock)
latvox_add_core_test(core_fields_test fields/fields_test.cc GTest::gmock)
latvox_add_core_test(core_links_test fields/links_test.cc)
latvox_add_core_test(core_links_parity_test fields/links_parity_test.cc)
if(TARGET core_links_parity_test)
  target_compile_definitions(
    core_links_parity_test PRIVATE LATVOX_FETCH_DRAGON="${PROJECT_SOURCE_DIR}/tests/bench/fetch-dragon"
                                   LATVOX_DRAGON_FOLDER="${CMAKE_BINARY_DIR}/dragon")
endif()
latvox_add_core_test(core_fraction_test fields/fraction_test.cc)
latvox_add_core_test(core_inside_test fields/inside_test.cc GTest::gmock)
latvox_add_core_test(core_label_fraction_test fields/label_fraction_test.cc)
latvox_add_core_test(core_numbers_alone_test fields/numbers_alone_test.cc)
if(LATVOX_BUILD_GRID)
  include(${PROJECT_SOURCE_DIR}/client/openvdb_module.cmake)
  find_package(OpenVDB REQUIRED)
endif()
latvox_add_core_test(core_band_openvdb_test band/band_openvdb_test.cc latvox::grid latvox::openvdb_trees)
latvox_add_core_test(core_principal_test digitize/principal_test.cc)
latvox_add_core_test(core_supercover_test supercover/supercover_test.cc)
latvox_add_core_test(core_box_cells_test supercover/box_cells_test.cc)
latvox_add_core_test(core_near_cells_test supercover/near_cells_test.cc)
latvox_add_core_test(core_candidates_test scan/candidates_test.cc)
latvox_add_core_test(core_line_scan_test scan/line_scan_test.cc)
latvox_add_core_test(core_open_stars_test scan/open_stars_test.cc)
latvox_add_core_test(core_row_spans_test scan/row_spans_test.cc)
if(TARGET core_row_spans_test) # compiled for the core's instruction sets
  target_compile_definitions(core_row_spans_test PRIVATE $<TARGET_PROPERTY:latvox_core,COMPILE_DEFINITIONS>)
  target_compile_options(core_row_spans_test PRIVATE $<TARGET_PROPERTY:latvox_core,COMPILE_OPTIONS>)
endif()
latvox_add_core_test(core_kernel_test scan/kernel_test.cc)
latvox_add_core_test(core_tiny_test tiny/tiny_test.cc THREADED)
latvox_add_core_test(core_tiny_cover_test tiny/tiny_cover_test.cc)
latvox_add_core_test(core_threads_test voxelizer/threads_test.cc THREADED)

# The programs whose results go through kernels, once more on the kernels that are not the best; see tests/README.md. Not
# the tests that go through all kernels by themselves, and two that are long and of other things.
if(NOT latvox_sanitized)
  foreach(program band band_openvdb bounds fields labeled_solid labeled_walk links parts snap solid supercover thesis_job
                  tile_tree voxelizer walk)
    if(NOT TARGET core_${program}_test)
      continue()
    endif()
    foreach(simd scalar avx2)
      set(name core_${program}_test.${simd})
      add_test(NAME ${name} COMMAND core_${program}_test --gtest_brief=1 --gtest_filter=-*Kernel*:*Bunny*:*CostAboutTheSame*)
      set_tests_properties(${name} PROPERTIES ENVIRONMENT LATVOX_SIMD=${simd} SKIP_RETURN_CODE 77
                           TIMEOUT ${latvox_test_seconds} LABELS slow)
    endforeach()
  endforeach()
endif()
