# The client's tests: foreign files, foreign answers, what is written, how the tool ends.
latvox_add_test(client_mesh_test SOURCES unit/client_mesh_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_encoder_test SOURCES unit/client_encoder_test.cc LIBRARIES latvox::tool draco::draco GTest::gmock)
latvox_add_test(client_curve_test SOURCES unit/client_curve_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_output_test SOURCES unit/client_output_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_grid_test SOURCES unit/client_grid_test.cc LIBRARIES latvox::grid GTest::gmock)
latvox_add_test(client_call_test SOURCES unit/client_call_test.cc LIBRARIES latvox::client latvox::proto GTest::gmock)
latvox_add_test(client_tool_test SOURCES unit/client_tool_test.cc LIBRARIES latvox::tool GTest::gmock)

# Both ends of one call.
latvox_add_test(plane_call_test SOURCES unit/plane_call_test.cc LIBRARIES latvox::client latvox::server GTest::gmock)
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
latvox_add_test(brick_codec_test SOURCES unit/brick_codec_test.cc
                LIBRARIES latvox::client latvox::server PkgConfig::zstd GTest::gmock)
