# What `cmake --install` and `cpack` put where. The component "decoder" is the C header alone, "nmc" the tool and the library.
include(CMakePackageConfigHelpers)
set(NMC_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/gltf-nmc)

install(TARGETS nmc_decode EXPORT gltf-nmc-decode-targets COMPONENT decoder)
install(FILES gltf_ext/c/nmc_decode.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT decoder)
install(EXPORT gltf-nmc-decode-targets NAMESPACE gltfnmc:: DESTINATION ${NMC_PACKAGE_DIR} COMPONENT decoder)

install(TARGETS nmc EXPORT gltf-nmc-targets ARCHIVE COMPONENT nmc LIBRARY COMPONENT nmc)
install(TARGETS gltf-nmc RUNTIME COMPONENT nmc)
if(NOT CMAKE_CROSSCOMPILING)
  set(NMC_REFERENCE ${CMAKE_BINARY_DIR}/reference)
  install(FILES ${NMC_REFERENCE}/gltf-nmc.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT nmc)
  install(FILES ${NMC_REFERENCE}/gltf-nmc.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME gltf-nmc COMPONENT nmc)
  install(FILES ${NMC_REFERENCE}/gltf-nmc.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT nmc)
  # Debian's zsh looks into the second folder, others into the first.
  foreach(folder site-functions vendor-completions)
    install(FILES ${NMC_REFERENCE}/_gltf-nmc DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder} COMPONENT nmc)
  endforeach()
endif()
foreach(room base gltf motion network codec report)
  install(DIRECTORY src/${room} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/gltf-nmc COMPONENT nmc FILES_MATCHING PATTERN "*.h")
endforeach()
install(EXPORT gltf-nmc-targets NAMESPACE gltfnmc:: DESTINATION ${NMC_PACKAGE_DIR} COMPONENT nmc)

configure_package_config_file(src/install/gltf-nmc-config.cmake.in ${CMAKE_BINARY_DIR}/package/gltf-nmc-config.cmake INSTALL_DESTINATION ${NMC_PACKAGE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/package/gltf-nmc-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/package/gltf-nmc-config.cmake ${CMAKE_BINARY_DIR}/package/gltf-nmc-config-version.cmake
        DESTINATION ${NMC_PACKAGE_DIR} COMPONENT decoder)

# Where the .pc file lies says where the prefix is, so that a package can be moved.
file(RELATIVE_PATH NMC_PREFIX_FROM_PC /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(src/install/nmc_decode.pc.in ${CMAKE_BINARY_DIR}/package/nmc_decode.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/package/nmc_decode.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT decoder)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT decoder)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME gltf-nmc)
set(CPACK_PACKAGE_CONTACT "The gltf-nmc contributors <gltf-nmc@users.noreply.github.com>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
include(CPack)
