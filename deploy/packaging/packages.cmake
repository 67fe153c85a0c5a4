# Debian packages of an ordinary build: deploy/packaging/build makes them. Each is a component of the installation; what
# belongs to no package stays out. The variables depend on the release that the packages are for, and the script sets
# them.
set(LATVOX_PACKAGE_RELEASE 1 CACHE STRING "Revision of the Debian packages, with the release: 1~deb12")
set(LATVOX_PACKAGE_SUITE unstable CACHE STRING "Debian release that the packages are for, as their change log names it")
set(LATVOX_PACKAGE_DATE "Thu, 01 Jan 1970 00:00:00 +0000" CACHE STRING "Date in the packages' change log")
set(LATVOX_PACKAGE_MAINTAINER "latvox maintainers <maintainers@localhost>" CACHE STRING "Maintainer of the packages")

set(latvox_packages)
# Adds the package NAME with the files of a component.
function(latvox_add_package COMPONENT NAME)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "SECTION;SUMMARY;TEXT;DEPENDS;SUGGESTS" "CONTROL")
  string(TOUPPER ${COMPONENT} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${NAME} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_FILE_NAME DEB-DEFAULT PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${ARG_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${ARG_SUMMARY}\n${ARG_TEXT}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${ARG_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SUGGESTS "${ARG_SUGGESTS}" PARENT_SCOPE)
  list(TRANSFORM ARG_CONTROL PREPEND ${CMAKE_CURRENT_LIST_DIR}/${NAME}/)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${ARG_CONTROL}" PARENT_SCOPE)
  set(latvox_packages ${latvox_packages} ${COMPONENT} PARENT_SCOPE)
  set(latvox_package_name_${COMPONENT} ${NAME} PARENT_SCOPE)
endfunction()

set(version ${PROJECT_VERSION}-${LATVOX_PACKAGE_RELEASE})
if(LATVOX_BUILD_TOOL)
  latvox_add_package(tool latvox SECTION science
    SUMMARY "exact voxels of triangle meshes on any lattice"
    TEXT "\
latvox turns triangle meshes into sparse voxels, exactly, on the Cartesian,
body-centered, face-centered, hexagonal or any other lattice of space, and
drawings into pixels. Surfaces are separating and minimal. It reads OBJ, PLY,
STL, OFF, glTF, 3MF and Draco, and writes OpenVDB, NanoVDB, tables, images and
pictures.

This package has the command line tool, its manual page, and completions for
shells."
    DEPENDS "latvoxd (= ${version})" SUGGESTS "glmark2-data, libcurl4 | libcurl4t64, libhdf5-103-1 | libhdf5-310")
endif()
if(LATVOX_BUILD_SERVER)
  latvox_add_package(server latvoxd SECTION science
    SUMMARY "voxelization of triangle meshes as a gRPC service"
    TEXT "\
latvoxd voxelizes triangle meshes for the tool latvox, and for programs in any
language, by gRPC. It has TLS, tokens, limits for each client, a memory budget
and metrics.

The service does not start by itself. The tool needs no service, because it
starts a private server for each call."
    CONTROL conffiles postinst prerm postrm)
endif()
latvox_add_package(sdk liblatvox-dev SECTION libdevel
  SUMMARY "exact voxels of triangle meshes, for C++ programs"
  TEXT "\
The C++20 library of latvox asks a server for voxels, or starts a private one.
It encodes meshes, reads mesh files, and makes OpenVDB grids of voxels.

This package has the headers, the static libraries, the files for CMake and
pkg-config, and the protocol."
  DEPENDS "libabsl-dev, libblosc-dev, libboost-iostreams-dev, libdraco-dev, libgrpc++-dev, libmeshoptimizer-dev, libopenvdb-dev, \
libprotobuf-dev, libpugixml-dev, libssl-dev, libtbb-dev, libzip-dev, libzstd-dev, pkgconf, protobuf-compiler-grpc, zlib1g-dev"
  SUGGESTS "latvoxd (= ${version})")
if(LATVOX_PYTHON)
  # The extension's file has the version of Python in its name, and no other version finds it.
  get_target_property(minor latvox_python LATVOX_PYTHON_MINOR)
  math(EXPR next "${minor} + 1")
  latvox_add_package(python python3-latvox SECTION python
    SUMMARY "exact voxels of triangle meshes, for Python"
    TEXT "\
latvox.voxelize takes mesh files, arrays, and meshes of trimesh, meshio,
PyVista and Open3D. Voxels and fields are arrays of numpy. Every option of the
tool latvox is a keyword argument."
    DEPENDS "latvox (= ${version}), latvoxd (= ${version}), python3-numpy, python3 (>= 3.${minor}), python3 (<< 3.${next})"
    CONTROL postinst prerm)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${latvox_packages})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_SET_DESTDIR ON) # the configuration belongs into /etc, beside the prefix
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PACKAGE_NAME latvox)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "") # each package has its own
set(CPACK_PACKAGE_CONTACT "${LATVOX_PACKAGE_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_RELEASE ${LATVOX_PACKAGE_RELEASE})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/documents.cmake)
set(CPACK_LATVOX_FOLDER ${CMAKE_CURRENT_LIST_DIR}) # for that script, as the next ones
set(CPACK_LATVOX_SUITE ${LATVOX_PACKAGE_SUITE})
set(CPACK_LATVOX_DATE "${LATVOX_PACKAGE_DATE}")
foreach(component IN LISTS latvox_packages)
  set(CPACK_LATVOX_NAME_${component} ${latvox_package_name_${component}})
endforeach()
include(CPack)
