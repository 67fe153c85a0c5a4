# The client's tests: foreign files, foreign answers, what is written, how the tool ends.
latvox_add_test(client_mesh_test SOURCES unit/client_mesh_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_gltf_test SOURCES unit/client_gltf_test.cc
                LIBRARIES latvox::tool nlohmann_json::nlohmann_json GTest::gmock)
latvox_add_test(client_encoder_test SOURCES unit/client_encoder_test.cc LIBRARIES latvox::tool draco::draco GTest::gmock)
latvox_add_test(client_attributes_test SOURCES unit/client_attributes_test.cc
                LIBRARIES latvox::tool draco::draco GTest::gmock)
latvox_add_test(client_curve_test SOURCES unit/client_curve_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_output_test SOURCES unit/client_output_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_compare_test SOURCES unit/client_compare_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_colors_test SOURCES unit/client_colors_test.cc
                LIBRARIES latvox::tool latvox::grid GTest::gmock)
latvox_add_test(client_scene_test SOURCES unit/client_scene_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_grid_test SOURCES unit/client_grid_test.cc LIBRARIES latvox::grid GTest::gmock)
foreach(name client_merge_test client_merge_errors_test)
  latvox_add_test(${name} SOURCES unit/${name}.cc LIBRARIES latvox::grid GTest::gmock)
endforeach()
foreach(name client_call_test client_attributes_call_test client_band_call_test client_call_end_test)
  latvox_add_test(${name} SOURCES unit/${name}.cc LIBRARIES latvox::client latvox::proto GTest::gmock)
endforeach()
add_library(latvox_model_server STATIC unit/client_model_server.cc unit/client_relay.cc)
target_link_libraries(latvox_model_server PUBLIC latvox::proto PRIVATE latvox_build latvox::client)
latvox_add_test(client_resume_test SOURCES unit/client_resume_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_retry_test SOURCES unit/client_retry_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_stream_test SOURCES unit/client_stream_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_options_test SOURCES unit/client_options_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_tool_test SOURCES unit/client_tool_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_job_test SOURCES unit/client_job_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_batch_test SOURCES unit/client_batch_test.cc LIBRARIES latvox::tool latvox::grid GTest::gmock)

# Both ends of one call.
latvox_add_test(plane_call_test SOURCES unit/plane_call_test.cc LIBRARIES latvox::client latvox::server GTest::gmock)
target_compile_definitions(plane_call_test PRIVATE LATVOXD="$<TARGET_FILE:latvoxd>")
add_dependencies(plane_call_test latvoxd)
latvox_add_test(client_failover_test UNSANITIZED SOURCES unit/client_failover_test.cc
                LIBRARIES latvox::client latvox_server_meshes GTest::gmock)
if(TARGET client_failover_test)
  target_compile_definitions(client_failover_test PRIVATE LATVOXD="$<TARGET_FILE:latvoxd>")
  add_dependencies(client_failover_test latvoxd)
endif()
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
latvox_add_test(brick_codec_test SOURCES unit/brick_codec_test.cc
                LIBRARIES latvox::client latvox::server PkgConfig::zstd GTest::gmock)
