# The server's tests: foreign bytes, the contract's rules, and whole calls through a real channel.
find_package(draco CONFIG REQUIRED)

add_library(latvox_server_meshes STATIC unit/server/meshes.cc)
target_link_libraries(latvox_server_meshes PUBLIC latvox::core PRIVATE latvox_build draco::draco)

latvox_add_test(server_decoder_test SOURCES unit/server/decode/decoder_test.cc
                LIBRARIES latvox::server latvox_server_meshes draco::draco GTest::gmock)
latvox_add_test(server_raw_mesh_test SOURCES unit/server/decode/raw_mesh_test.cc LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_decoder_protocol_test SOURCES unit/server/decode/decoder_protocol_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
# Seccomp forbids calls that sanitizers need.
latvox_add_test(server_decoder_sandbox_test UNSANITIZED SOURCES unit/server/decode/decoder_sandbox_test.cc
                LIBRARIES latvox::server ${LATVOX_SECCOMP} GTest::gmock)
latvox_add_test(server_decoder_pool_test SOURCES unit/server/decode/decoder_pool_test.cc
                                                 unit/server/decode/foreign_decoder_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
target_compile_definitions(
  server_decoder_pool_test
  PRIVATE LATVOX_RESERVE_BOMB="${PROJECT_SOURCE_DIR}/tests/fuzz/corpus/decoder_fuzz/reserve_bomb_61.drc")
latvox_add_test(server_errors_test SOURCES unit/server/base/errors_test.cc LIBRARIES latvox::server)
latvox_add_test(server_rules_test SOURCES unit/server/wire/rules_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_computation_test SOURCES unit/server/work/computation_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_brick_batch_test SOURCES unit/server/wire/brick_batch_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_mesh_upload_test SOURCES unit/server/work/mesh_upload_test.cc LIBRARIES latvox::server)
latvox_add_test(server_job_memory_test SOURCES unit/server/work/job_memory_test.cc LIBRARIES latvox::server)
latvox_add_test(server_solid_test SOURCES unit/server/work/solid_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_attributes_test SOURCES unit/server/wire/attributes_test.cc
                LIBRARIES latvox::server latvox_server_meshes draco::draco GTest::gmock)
latvox_add_test(server_call_registry_test SOURCES unit/server/calls/call_registry_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_memory_budget_test SOURCES unit/server/work/memory_budget_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_unfinished_uploads_test SOURCES unit/server/work/unfinished_uploads_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_mesh_store_test SOURCES unit/server/decode/mesh_store_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_activated_sockets_test SOURCES unit/server/base/activated_sockets_test.cc
                LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_socket_acceptor_test SOURCES unit/server/listen/socket_acceptor_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_control_group_test SOURCES unit/server/base/control_group_test.cc LIBRARIES latvox::server)
latvox_add_test(server_resume_test SOURCES unit/server/calls/resume_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_one_message_test SOURCES unit/server/calls/one_message_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_access_test SOURCES unit/server/access/access_test.cc LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_access_call_test SOURCES unit/server/access/access_call_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_frame_guard_test SOURCES unit/server/guard/frame_guard_test.cc LIBRARIES latvox::server)
latvox_add_test(server_guard_test SOURCES unit/server/guard/connections_test.cc LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_call_test SOURCES unit/server/calls/call_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_message_test SOURCES unit/server/calls/message_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_call_end_test SOURCES unit/server/calls/call_end_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_tiny_job_test SOURCES unit/server/calls/tiny_job_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_turns_test SOURCES unit/server/calls/turns_test.cc
                LIBRARIES latvox::server latvox_server_meshes GTest::gmock)
latvox_add_test(server_request_log_test SOURCES unit/server/calls/request_log_test.cc LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_log_test SOURCES unit/server/base/log_test.cc LIBRARIES latvox::server)
latvox_add_test(server_work_queue_test SOURCES unit/server/work/work_queue_test.cc LIBRARIES latvox::server TBB::tbb)
latvox_add_test(server_work_lanes_test SOURCES unit/server/work/work_lanes_test.cc LIBRARIES latvox::server TBB::tbb)
latvox_add_test(server_metrics_test SOURCES unit/server/calls/metrics_test.cc LIBRARIES latvox::server GTest::gmock)
latvox_add_test(server_process_test UNSANITIZED SOURCES unit/server/listen/process_test.cc LIBRARIES latvox::proto GTest::gmock)

# Tests that start the server's program, as a whole or as what decodes meshes.
foreach(test server_access_call_test server_call_test server_call_end_test server_decoder_pool_test server_decoder_sandbox_test
             server_message_test server_one_message_test server_process_test server_resume_test server_socket_acceptor_test
             server_tiny_job_test server_turns_test)
  if(TARGET ${test})
    target_compile_definitions(${test} PRIVATE LATVOXD="$<TARGET_FILE:latvoxd>")
    add_dependencies(${test} latvoxd)
  endif()
endforeach()
