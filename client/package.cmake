# Installs the SDK for other programs: libraries, headers, a CMake package, and files for pkg-config. They may be moved
# together, because no file has a path of this machine.
include(CMakePackageConfigHelpers)
set(latvox_package ${CMAKE_INSTALL_LIBDIR}/cmake/latvox)

# Installs the archive latvox_PART as latvox::PART, or with BUILD_SHARED_LIBS a shared library of the same objects. The
# tool and the tests always link the archives, because they use symbols that a shared library hides.
#   DESCRIPTION      for people, in pkg-config's file
#   MAP              the linker's list of the symbols that the shared library may show
#   PUBLIC           the libraries that a user of latvox::PART links besides
#   REQUIRES         pkg-config's names of packages that the public headers need
#   REQUIRES_STATIC  the same, of packages that the archive needs to be linked
#   LIBS_STATIC      the same, of libraries that pkg-config does not know
function(latvox_install_part PART)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "DESCRIPTION;MAP" "PUBLIC;REQUIRES;REQUIRES_STATIC;LIBS_STATIC")
  set(target latvox_${PART})
  if(latvox_shared)
    set(target latvox_${PART}_shared)
    list(TRANSFORM ARG_PUBLIC REPLACE "^latvox_(.*)$" "latvox_\\1_shared")
    set(ARG_REQUIRES_STATIC "") # they are linked already
    set(ARG_LIBS_STATIC "")
    add_library(${target} SHARED $<TARGET_OBJECTS:latvox_${PART}>)
    target_compile_features(${target} PUBLIC cxx_std_20)
    target_include_directories(${target} PUBLIC
      $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    # Never the client's archive: it would register the protocol's messages a second time.
    get_target_property(libraries latvox_${PART} LINK_LIBRARIES)
    list(TRANSFORM libraries REPLACE "^latvox_(client|mesh)$" "latvox_\\1_shared")
    target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${libraries})
    target_link_options(${target} PRIVATE LINKER:--version-script,${CMAKE_CURRENT_SOURCE_DIR}/${ARG_MAP} LINKER:-z,defs)
    set_target_properties(${target} PROPERTIES
      LINK_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_MAP}
      OUTPUT_NAME latvox_${PART} LINKER_LANGUAGE CXX INSTALL_RPATH $ORIGIN
      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  endif()
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${PART})
  install(TARGETS ${target} EXPORT latvox_${PART} COMPONENT sdk)
  latvox_install_needs(${target} $<TARGET_FILE:${target}>)
  install(EXPORT latvox_${PART} NAMESPACE latvox:: DESTINATION ${latvox_package} FILE latvox-${PART}.cmake
          COMPONENT sdk)
  latvox_install_pkg_config(${PART})
endfunction()

# Called by latvox_install_part, whose variables it uses.
function(latvox_install_pkg_config PART)
  set(name latvox)
  if(NOT PART STREQUAL client)
    string(REPLACE "_" "-" name latvox-${PART})
  endif()
  file(RELATIVE_PATH up /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" up ${up})
  list(JOIN ARG_REQUIRES " " requires)
  list(JOIN ARG_REQUIRES_STATIC " " requires_static)
  list(JOIN ARG_LIBS_STATIC " " libs_static)
  configure_file(latvox.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT sdk)
endfunction()

# Installs the headers of the parts that are built, and the files for find_package(latvox).
function(latvox_install_package)
  install(DIRECTORY include/latvox DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT sdk PATTERN mesh EXCLUDE
          PATTERN mesh_files EXCLUDE PATTERN grid EXCLUDE)
  foreach(part mesh mesh_files grid)
    if(TARGET latvox_${part})
      install(DIRECTORY include/latvox/${part} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/latvox COMPONENT sdk)
    endif()
  endforeach()
  configure_package_config_file(latvoxConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/latvoxConfig.cmake
                                INSTALL_DESTINATION ${latvox_package})
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/latvoxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/latvoxConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/latvoxConfigVersion.cmake
          openvdb_module.cmake
          DESTINATION ${latvox_package} COMPONENT sdk)
endfunction()

# Installs the protocol, for programs in other languages, and what people read: pages, pictures, examples, license.
function(latvox_install_documents)
  set(proto ${CMAKE_INSTALL_DATADIR}/latvox/proto)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/proto/latvox ${PROJECT_SOURCE_DIR}/proto/google DESTINATION ${proto}
          COMPONENT sdk FILES_MATCHING PATTERN *.proto)
  install(FILES ${PROJECT_SOURCE_DIR}/proto/README.md DESTINATION ${proto} COMPONENT sdk)
  install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk USE_SOURCE_PERMISSIONS)
  install(DIRECTORY docs/pictures DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tool FILES_MATCHING PATTERN *.png
          PATTERN *.svg)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT license)

  file(RELATIVE_PATH headers /${CMAKE_INSTALL_DOCDIR} /${CMAKE_INSTALL_INCLUDEDIR})
  file(RELATIVE_PATH proto /${CMAKE_INSTALL_DOCDIR} /${proto})
  file(GLOB pages CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/client/docs/*.md ${PROJECT_SOURCE_DIR}/server/docs/*.md)
  set(made)
  foreach(page IN LISTS pages)
    cmake_path(GET page FILENAME name)
    set(out ${CMAKE_CURRENT_BINARY_DIR}/pages/${name})
    add_custom_command(
      OUTPUT ${out}
      COMMAND ${CMAKE_COMMAND} -D PAGE=${page} -D OUT=${out} -D HEADERS=${headers} -D PROTO=${proto} -P
              ${CMAKE_CURRENT_SOURCE_DIR}/docs/installed_page.cmake
      DEPENDS ${page} ${CMAKE_CURRENT_SOURCE_DIR}/docs/installed_page.cmake
      COMMENT "Writing ${name}"
      VERBATIM)
    list(APPEND made ${out})
  endforeach()
  add_custom_target(latvox_documents ALL DEPENDS ${made})
  latvox_install_needs(latvox_documents ${made})
  install(FILES ${made} DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tool)
endfunction()
