# cmake --install: programs, the command `wade` with its scenes and the page of the viewer, libwade_shm with header, CMake package and pkg-config file,
# man pages, completion for bash, documents. CPack makes a .deb of the same files (preset "package": for any processor).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(packaging ${PROJECT_SOURCE_DIR}/packaging)
set(share ${CMAKE_INSTALL_DATADIR}/wade)
set(installed_programs fluid_server crowd_client shm_inspect shm_clean shm_record shm_replay)

install(TARGETS ${installed_programs} wade_view_server)
if(TARGET fluid_server_ranks)
  install(TARGETS fluid_server_ranks)
endif()

# The library for producers and consumers in other programs.
install(TARGETS wade_shm_c EXPORT WadeShm LIBRARY NAMELINK_COMPONENT development)
install(FILES shm_protocol/c_api/wade_shm.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/WadeShm)
install(EXPORT WadeShm NAMESPACE WadeShm:: DESTINATION ${package} FILE WadeShmConfig.cmake COMPONENT development)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/WadeShmConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/WadeShmConfigVersion.cmake DESTINATION ${package} COMPONENT development)
configure_file(${packaging}/wade_shm.pc.in ${PROJECT_BINARY_DIR}/wade_shm.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/wade_shm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# The command and what it reads. It finds the programs beside itself.
file(RELATIVE_PATH share_from_bin ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/wade)
configure_file(${packaging}/wade.in ${PROJECT_BINARY_DIR}/packaging/wade @ONLY)
install(PROGRAMS ${PROJECT_BINARY_DIR}/packaging/wade DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY tools/python DESTINATION ${share}/tools PATTERN "*.md" EXCLUDE PATTERN __pycache__ EXCLUDE)
install(DIRECTORY tools/viewer/page DESTINATION ${share}/tools/viewer PATTERN node_modules EXCLUDE)
install(FILES tools/viewer/film.mjs DESTINATION ${share}/tools/viewer)
# All data of the scenes, whatever their format; no sources.
install(DIRECTORY configs DESTINATION ${share}
  REGEX "/(CMakeLists.txt|[^/]*[.](cpp|hpp|inc|cmake|md|py))$" EXCLUDE
  REGEX "/configs/(checks|errors|files|json|loading|numbers|program|scene/fields)$" EXCLUDE)

# Completion: one function for all, found by the name of the command.
set(completions ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
install(FILES packaging/completion.bash DESTINATION ${completions} RENAME wade)
foreach(program ${installed_programs})
  install(FILES packaging/completion.bash DESTINATION ${completions} RENAME ${program})
endforeach()

# Man pages are what --help says.
find_program(WADE_HELP2MAN help2man DOC "Makes man pages from --help")
wade_optional(has_help2man "man pages" "the package help2man makes them" MAKES ${PROJECT_BINARY_DIR}/optional/page.1
  COMMAND ${WADE_HELP2MAN} --no-info --output=${PROJECT_BINARY_DIR}/optional/page.1 ${CMAKE_COMMAND})
if(has_help2man)
  set(pages)
  foreach(program ${installed_programs})
    set(page ${PROJECT_BINARY_DIR}/man/${program}.1)
    add_custom_command(OUTPUT ${page}
      COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/man
      COMMAND ${WADE_HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --source=Wade
        --include=${packaging}/man_names.h2m --output=${page} $<TARGET_FILE:${program}>
      DEPENDS ${program} ${packaging}/man_names.h2m COMMENT "Man page of ${program}" VERBATIM)
    list(APPEND pages ${page})
  endforeach()
  set(page ${PROJECT_BINARY_DIR}/man/wade.1)
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E env WADE_INSTALLED=1
      ${WADE_HELP2MAN} --no-info --version-string=${PROJECT_VERSION} --source=Wade
      --include=${packaging}/man_names.h2m --output=${page} ${PROJECT_SOURCE_DIR}/tools/wade
    DEPENDS ${pages} tools/python/wade/commands.py COMMENT "Man page of wade" VERBATIM)
  add_custom_target(man_pages ALL DEPENDS ${pages} ${page})
  install(FILES ${pages} ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()

install(FILES README.md LICENSE CHANGELOG.md CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY tools/engines tools/producers DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples
  PATTERN CMakeLists.txt EXCLUDE PATTERN __pycache__ EXCLUDE)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} FILES_MATCHING PATTERN "*.md" PATTERN reports EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME wade)
set(CPACK_PACKAGE_VENDOR "The Wade project")
set(CPACK_PACKAGE_CONTACT "The developers of Wade")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "People in floods: water and crowd, coupled through shared memory")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS python3)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy, python3-matplotlib, python3-pil, python3-scipy, python3-tabulate")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "npm, chromium, ffmpeg, gdal-bin, blender, parallel, openmpi-bin")
include(CPack)
