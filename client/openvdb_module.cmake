# Shows CMake OpenVDB's find module, which Debian, Fedora, conda, Homebrew and vcpkg keep in different places below their
# prefixes. CMake looks for configurations there, but not for modules.
set(latvox_openvdb_modules lib/cmake/OpenVDB/FindOpenVDB.cmake lib64/cmake/OpenVDB/FindOpenVDB.cmake
  share/openvdb/FindOpenVDB.cmake)
if(CMAKE_LIBRARY_ARCHITECTURE)
  list(PREPEND latvox_openvdb_modules lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB/FindOpenVDB.cmake)
endif()
find_file(LATVOX_OPENVDB_MODULE NAMES ${latvox_openvdb_modules}
  HINTS ${OpenVDB_ROOT} ENV OpenVDB_ROOT ${CMAKE_PREFIX_PATH} ENV CMAKE_PREFIX_PATH PATHS ${CMAKE_SYSTEM_PREFIX_PATH}
  DOC "OpenVDB's FindOpenVDB.cmake")
mark_as_advanced(LATVOX_OPENVDB_MODULE)
if(LATVOX_OPENVDB_MODULE)
  cmake_path(GET LATVOX_OPENVDB_MODULE PARENT_PATH latvox_openvdb_folder)
  list(APPEND CMAKE_MODULE_PATH ${latvox_openvdb_folder})
endif()
