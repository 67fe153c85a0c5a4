# The core's tests: units, and the two exact tiers (scalar = oracle, pipeline = oracle).
latvox_add_test(core_lattice_test SOURCES unit/core_lattice_test.cc LIBRARIES latvox::core latvox_oracle)
latvox_add_test(core_snap_test SOURCES unit/core_snap_test.cc LIBRARIES latvox::core)
latvox_add_test(core_crossing_test SOURCES unit/core_crossing_test.cc LIBRARIES latvox::core latvox_oracle)
latvox_add_test(core_voxelizer_test SOURCES unit/core_voxelizer_test.cc LIBRARIES latvox::core latvox_oracle)
latvox_add_test(core_oracle_test SOURCES unit/core_oracle_test.cc LIBRARIES latvox::core latvox_oracle)
