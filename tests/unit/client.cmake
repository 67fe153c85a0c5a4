# The client's tests: foreign files, foreign answers, what is written, how the tool ends.
if(LATVOX_BUILD_MESH)
  find_package(draco CONFIG REQUIRED)
endif()
latvox_add_test(client_mesh_test SOURCES unit/client/mesh_files/mesh_test.cc LIBRARIES latvox::mesh_files GTest::gmock)
latvox_add_test(client_ply_arrays_test SOURCES unit/client/mesh_files/ply_arrays_test.cc
                LIBRARIES latvox::mesh_files GTest::gmock)
latvox_add_test(client_tolerance_test SOURCES unit/client/mesh_files/tolerance_test.cc
                LIBRARIES latvox::mesh_files GTest::gmock)
latvox_add_test(client_read_mesh_file_test SOURCES unit/client/mesh_files/read_mesh_file_test.cc
                LIBRARIES latvox::mesh_files GTest::gmock)
latvox_add_test(client_polygon_test SOURCES unit/client/mesh_files/polygon_test.cc LIBRARIES latvox::mesh_files)
latvox_add_test(client_number_text_test SOURCES unit/client/mesh_files/number_text_test.cc LIBRARIES latvox::mesh_files)
foreach(name gltf_test gltf_scene_test)
  latvox_add_test(client_${name} SOURCES unit/client/mesh_files/${name}.cc
                  LIBRARIES latvox::mesh_files nlohmann_json::nlohmann_json GTest::gmock)
endforeach()
latvox_add_test(client_off_test SOURCES unit/client/mesh_files/off_test.cc LIBRARIES latvox::mesh_files GTest::gmock)
if(LATVOX_BUILD_MESH_FILES)
  find_package(meshoptimizer CONFIG REQUIRED)
endif()
latvox_add_test(client_gltf_meshopt_test SOURCES unit/client/mesh_files/gltf_meshopt_test.cc
                LIBRARIES latvox::mesh_files meshoptimizer::meshoptimizer nlohmann_json::nlohmann_json GTest::gmock)
latvox_add_test(client_three_mf_test SOURCES unit/client/mesh_files/three_mf_test.cc
                LIBRARIES latvox::mesh_files GTest::gmock)
latvox_add_test(client_encoder_test SOURCES unit/client/mesh/encoder_test.cc LIBRARIES latvox::mesh draco::draco GTest::gmock)
latvox_add_test(client_attributes_test SOURCES unit/client/mesh/attributes_test.cc
                LIBRARIES latvox::mesh_files draco::draco GTest::gmock)
latvox_add_test(client_curve_test SOURCES unit/client/tool/curve/curve_test.cc unit/client/tool/curve/names_test.cc
                unit/client/tool/curve/style_test.cc
                LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_output_test SOURCES unit/client/tool/output/output_test.cc
                LIBRARIES latvox::tool latvox::grid GTest::gmock)
latvox_add_test(client_outputs_test SOURCES unit/client/tool/output/cancelled_test.cc
                        unit/client/tool/output/outputs_test.cc
                LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_image_test SOURCES unit/client/tool/output/image_test.cc
                LIBRARIES latvox::tool ZLIB::ZLIB GTest::gmock)
latvox_add_test(client_packed_blocks_test SOURCES unit/client/tool/output/packed_blocks_test.cc
                LIBRARIES latvox::tool TBB::tbb ZLIB::ZLIB GTest::gmock)
latvox_add_test(client_compare_test SOURCES unit/client/tool/cli/compare_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_colors_test SOURCES unit/client/tool/output/colors_test.cc
                LIBRARIES latvox::tool latvox::grid latvox::openvdb_trees GTest::gmock)
latvox_add_test(client_palette_test SOURCES unit/client/tool/output/palette_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_picture_style_test SOURCES unit/client/tool/output/picture_style_test.cc
                LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_scene_test SOURCES unit/client/tool/output/scene_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_grid_test SOURCES unit/client/grid/grid_test.cc unit/client/grid/grid_reading_test.cc
                LIBRARIES latvox::grid latvox::openvdb_trees GTest::gmock)
latvox_add_test(client_grid_frame_test SOURCES unit/client/grid/grid_frame_test.cc LIBRARIES latvox::grid GTest::gmock)
foreach(name content_join_test link_grids_test merge_test merge_errors_test voxel_file_test)
  latvox_add_test(client_${name} SOURCES unit/client/grid/${name}.cc
                  LIBRARIES latvox::grid latvox::openvdb_trees GTest::gmock)
endforeach()
foreach(name call_test call_end_test dense_test error_test fields_call_test walk_call_test)
  latvox_add_test(client_${name} THREADED SOURCES unit/client/internal/${name}.cc
                  LIBRARIES latvox::client latvox::proto GTest::gmock)
endforeach()
add_library(latvox_model_server STATIC unit/client/model_server.cc unit/client/relay.cc)
target_link_libraries(latvox_model_server PUBLIC latvox::proto PRIVATE latvox_build latvox::client)
latvox_add_test(client_resume_test THREADED SOURCES unit/client/internal/resume_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_retry_test THREADED SOURCES unit/client/internal/retry_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_stream_test THREADED SOURCES unit/client/internal/stream_test.cc
                LIBRARIES latvox::client latvox_model_server GTest::gmock)
latvox_add_test(client_remote_test SOURCES unit/client/tool/remote/remote_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_texture_test SOURCES unit/client/tool/texture/texture_test.cc LIBRARIES latvox::tool)
latvox_add_test(client_content_wire_test SOURCES unit/client/tool/confined/content_wire_test.cc
                LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_options_test SOURCES unit/client/tool/cli/dims_resolution_test.cc
                        unit/client/tool/cli/file_options_test.cc unit/client/tool/cli/options_test.cc
                LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_tool_test SOURCES unit/client/tool/cli/tool_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_job_test SOURCES unit/client/tool/cli/job_test.cc LIBRARIES latvox::tool GTest::gmock)
latvox_add_test(client_batch_test SOURCES unit/client/tool/cli/batch_test.cc LIBRARIES latvox::tool latvox::grid GTest::gmock)

# Both ends of one call.
latvox_add_test(named_lattices_test SOURCES unit/both_ends/named_lattices_test.cc
                LIBRARIES latvox::core latvox::client latvox::proto)
latvox_add_test(plane_call_test THREADED SOURCES unit/both_ends/plane_call_test.cc
                LIBRARIES latvox::client latvox::server GTest::gmock)
latvox_add_test(request_rules_test UNSANITIZED SOURCES unit/both_ends/request_rules_test.cc
                LIBRARIES latvox::client latvox::server latvox::tool latvox_server_meshes GTest::gmock)
latvox_add_test(option_words_test SOURCES unit/both_ends/option_words_test.cc
                LIBRARIES latvox::core latvox::tool latvox::proto GTest::gmock)
if(TARGET request_rules_test)
  target_compile_definitions(request_rules_test PRIVATE LATVOX="$<TARGET_FILE:latvox>" LATVOXD="$<TARGET_FILE:latvoxd>")
  add_dependencies(request_rules_test latvox latvoxd)
endif()
latvox_add_test(client_private_server_test UNSANITIZED SOURCES unit/client/internal/private_server_test.cc
                LIBRARIES latvox::client latvox_server_meshes GTest::gmock)
latvox_add_test(client_failover_test UNSANITIZED SOURCES unit/client/internal/failover_test.cc
                LIBRARIES latvox::client latvox_server_meshes GTest::gmock)
foreach(test plane_call_test client_failover_test client_private_server_test)
  if(TARGET ${test})
    target_compile_definitions(${test} PRIVATE LATVOXD="$<TARGET_FILE:latvoxd>")
    add_dependencies(${test} latvoxd)
  endif()
endforeach()
find_package(PkgConfig REQUIRED)
pkg_check_modules(zstd REQUIRED IMPORTED_TARGET libzstd)
latvox_add_test(brick_codec_test SOURCES unit/both_ends/brick_batch_test.cc unit/both_ends/brick_codec_test.cc
                LIBRARIES latvox::client latvox::server PkgConfig::zstd GTest::gmock)
