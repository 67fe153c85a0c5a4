# Rooms without a test program of their own, and their tests: programs of higher rooms, or whole programs.
latvox_test_room(core/mesh core_water_test core_voxelizer_test)
latvox_test_room(core/thin core_fine_test core_voxelizer_test)
latvox_test_room(core/tile core_kernel_test core_tiny_test)

# The code in the public headers, and the code that they declare.
latvox_test_room(client/include client_call_test client_encoder_test client_grid_test)

# Code that reads and writes JSON.
latvox_test_room(client/json client_gltf_test client_job_test)

latvox_test_room_from_outside(server/config TESTS e2e.config PROGRAMS latvox latvoxd)
latvox_test_room_from_outside(server/main.cc TESTS e2e.config PROGRAMS latvox latvoxd)
latvox_test_room_from_outside(client/python TESTS python.package PROGRAMS latvox latvoxd)
if(TARGET latvox_python) # with LATVOX_PYTHON, which tests/run turns on for this room
  latvox_build_for_room(client/python latvox_python)
endif()
latvox_test_room_from_outside(client/tool/hdf5 TESTS e2e.hdf5 PROGRAMS latvox latvoxd)
latvox_test_room_from_outside(client/tool/inspect TESTS e2e.info PROGRAMS latvox latvoxd)
latvox_test_room_from_outside(client/tool/vdb TESTS e2e.openvdb_late PROGRAMS latvox latvoxd)
latvox_test_room_from_outside(client/tool/view TESTS e2e.view node.view PROGRAMS latvox latvoxd)
