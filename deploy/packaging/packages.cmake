# Debian packages of an ordinary build: deploy/packaging/build makes them. Each has one component of the installation,
# or several; what belongs to no package stays out. The variables depend on the release that the packages are for, and
# the script sets them.
set(LATVOX_PACKAGE_RELEASE 1 CACHE STRING "Revision of the Debian packages, with the release: 1~deb12")
set(LATVOX_PACKAGE_SUITE unstable CACHE STRING "Debian release that the packages are for, as their change log names it")
set(LATVOX_PACKAGE_DATE "Thu, 01 Jan 1970 00:00:00 +0000" CACHE STRING "Date in the packages' change log")
set(LATVOX_PACKAGE_MAINTAINER "latvox maintainers <maintainers@localhost>" CACHE STRING "Maintainer of the packages")

set(latvox_packages)
set(latvox_packed)
# Adds the package NAME with the files of COMPONENTS. CPack calls that a group, whose files lie in a folder of its name.
function(latvox_add_package NAME)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "SECTION;SUMMARY;TEXT;DEPENDS;RECOMMENDS;SUGGESTS;BREAKS"
                        "COMPONENTS;CONTROL")
  string(TOUPPER ${NAME} upper)
  foreach(component IN LISTS ARG_COMPONENTS)
    string(TOUPPER ${component} member)
    set(CPACK_COMPONENT_${member}_GROUP ${NAME} PARENT_SCOPE)
  endforeach()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${NAME} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_FILE_NAME DEB-DEFAULT PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${ARG_SECTION} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${ARG_SUMMARY}\n${ARG_TEXT}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${ARG_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${ARG_RECOMMENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SUGGESTS "${ARG_SUGGESTS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_BREAKS "${ARG_BREAKS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_REPLACES "${ARG_BREAKS}" PARENT_SCOPE) # their files move here
  list(TRANSFORM ARG_CONTROL PREPEND ${CMAKE_CURRENT_LIST_DIR}/${NAME}/)
  set(CPACK_DEBIAN_${upper}_PACKAGE_CONTROL_EXTRA "${ARG_CONTROL}" PARENT_SCOPE)
  set(latvox_packages ${latvox_packages} ${NAME} PARENT_SCOPE)
  set(latvox_packed ${latvox_packed} ${ARG_COMPONENTS} PARENT_SCOPE)
endfunction()

set(version ${PROJECT_VERSION}-${LATVOX_PACKAGE_RELEASE})
if(LATVOX_BUILD_TOOL)
  set(programs tool)
  if(LATVOX_BUILD_SERVER)
    list(APPEND programs server)
  endif()
  latvox_add_package(latvox COMPONENTS ${programs} SECTION science
    SUMMARY "exact voxels of triangle meshes on any lattice"
    TEXT "\
latvox turns triangle meshes into sparse voxels, exactly, on the Cartesian,
body-centered, face-centered, hexagonal or any other lattice of space, and
drawings into pixels. Surfaces are separating and minimal. It reads OBJ, PLY,
STL, OFF, glTF, 3MF and Draco, and writes OpenVDB, NanoVDB, tables, images and
pictures.

This package has the command line tool, the server latvoxd, which the tool
starts for each call, their manual pages, and completions for shells."
    # The bunny of the examples; URLs; .h5 files.
    RECOMMENDS "glmark2-data, libcurl4 | libcurl4t64, libhdf5-103-1 | libhdf5-310"
    BREAKS "latvoxd (<< ${version})") # it had the server
endif()
if(LATVOX_BUILD_TOOL AND LATVOX_BUILD_SERVER)
  latvox_add_package(latvoxd COMPONENTS service SECTION science
    SUMMARY "voxelization of triangle meshes as a gRPC service"
    TEXT "\
latvoxd voxelizes triangle meshes for the tool latvox, and for programs in any
language, by gRPC. It has TLS, tokens, limits for each client, a memory budget
and metrics.

This package has the service for systemd and its configuration. The service
does not start by itself. The tool needs no service, because it starts a
private server for each call."
    DEPENDS "latvox (= ${version})" CONTROL conffiles postinst prerm postrm)
endif()
latvox_add_package(liblatvox-dev COMPONENTS sdk SECTION libdevel
  SUMMARY "exact voxels of triangle meshes, for C++ programs"
  TEXT "\
The C++20 library of latvox asks a server for voxels, or starts a private one.
It encodes meshes, reads mesh files, and makes OpenVDB grids of voxels.

This package has the headers, the static libraries, the files for CMake and
pkg-config, and the protocol."
  # libzip-dev names bz2 and lzma for static programs, and does not depend on them.
  DEPENDS "libabsl-dev, libblosc-dev, libboost-iostreams-dev, libbz2-dev, libdraco-dev, libgrpc++-dev, liblzma-dev, \
libmeshoptimizer-dev, libopenvdb-dev, libprotobuf-dev, libpugixml-dev, libssl-dev, libtbb-dev, libzip-dev, libzstd-dev, pkgconf, \
protobuf-compiler-grpc, zlib1g-dev"
  SUGGESTS "latvox (= ${version})")
if(LATVOX_PYTHON)
  # The extension's file has the version of Python in its name, and no other version finds it.
  get_target_property(minor latvox_python LATVOX_PYTHON_MINOR)
  math(EXPR next "${minor} + 1")
  latvox_add_package(python3-latvox COMPONENTS python SECTION python
    SUMMARY "exact voxels of triangle meshes, for Python"
    TEXT "\
latvox.voxelize takes mesh files, arrays, and meshes of trimesh, meshio,
PyVista and Open3D. Voxels and fields are arrays of numpy. Every option of the
tool latvox is a keyword argument."
    DEPENDS "latvox (= ${version}), python3-numpy, python3 (>= 3.${minor}), python3 (<< 3.${next})"
    CONTROL postinst prerm)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_COMPONENTS_ALL ${latvox_packed})
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
set(CPACK_LATVOX_PACKAGES ${latvox_packages})
include(CPack)
