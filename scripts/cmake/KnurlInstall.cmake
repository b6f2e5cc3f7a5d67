# `cmake --install` leaves programs (each app installs its own), headers, static libraries (each module its own), and
# two ways to find them from outside, which are made here: find_package(knurl COMPONENTS client) and pkg-config knurl.

include(CMakePackageConfigHelpers)

set(knurl_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/knurl)
install(EXPORT knurlTargets NAMESPACE knurl:: DESTINATION ${knurl_package_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/knurlConfig.cmake.in ${CMAKE_BINARY_DIR}/knurlConfig.cmake
                              INSTALL_DESTINATION ${knurl_package_dir})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${CMAKE_BINARY_DIR}/knurlConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/knurlConfig.cmake ${CMAKE_BINARY_DIR}/knurlConfigVersion.cmake
        DESTINATION ${knurl_package_dir})

# The way from lib*/pkgconfig (two levels down, or three on Debian's multiarch) up to the prefix.
file(RELATIVE_PATH knurl_pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/knurl.pc.in ${CMAKE_BINARY_DIR}/knurl.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/knurl.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
