# Run by CPack over the files of all packages: adds what Debian's policy asks of a package, and other installations need
# not have. All times are the same, so that equal files make equal packages.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

foreach(name IN LISTS CPACK_LATVOX_PACKAGES)
  set(root ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${name})
  set(documents ${root}/usr/share/doc/${name})
  configure_file(${CPACK_LATVOX_FOLDER}/changelog.in ${documents}/changelog.Debian @ONLY)
  configure_file(${CPACK_LATVOX_FOLDER}/copyright ${documents}/copyright COPYONLY)
  configure_file(${CPACK_LATVOX_FOLDER}/../CHANGELOG.md ${documents}/changelog COPYONLY)
  file(GLOB pages ${root}/usr/share/man/man*/*.[1-9] ${documents}/changelog*)
  foreach(page IN LISTS pages)
    run(gzip --best --no-name --force ${page})
  endforeach()
  run(chmod -R u=rwX,go=rX ${root})
  run(find ${root} -exec touch --no-dereference --date=@$ENV{SOURCE_DATE_EPOCH} {} +)
endforeach()
