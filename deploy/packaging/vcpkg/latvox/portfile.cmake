# Builds the checkout that this file lies in. vcpkg does not notice changes of its sources.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../../.." ABSOLUTE)
vcpkg_find_acquire_program(PKGCONFIG)
# OpenVDB's port has NanoVDB only with CUDA, so grids are left out, and with them the tool.
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS "-DPKG_CONFIG_EXECUTABLE=${PKGCONFIG}"
          -DLATVOX_BUILD_SERVER=OFF -DLATVOX_BUILD_TOOL=OFF -DLATVOX_BUILD_GRID=OFF -DBUILD_TESTING=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/latvox)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
