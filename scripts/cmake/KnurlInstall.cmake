# `cmake --install` leaves programs (each app installs its own), headers, static libraries (each module its own), and
# two ways to find them from outside, which are made here: find_package(knurl) and pkg-config knurl.

include(CMakePackageConfigHelpers)

set(knurl_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/knurl)
install(EXPORT knurlTargets NAMESPACE knurl:: DESTINATION ${knurl_package_dir})
get_property(knurl_modules GLOBAL PROPERTY KNURL_MODULES)
list(JOIN knurl_modules ", " knurl_modules_text)
set(knurl_needs "")
foreach(module IN LISTS knurl_modules)
    get_property(needs GLOBAL PROPERTY KNURL_NEEDS_${module})
    list(JOIN needs " " needs)
    string(APPEND knurl_needs "set(knurl_needs_${module} ${needs})\n")
endforeach()
list(JOIN knurl_modules " " knurl_modules)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/knurlConfig.cmake.in ${PROJECT_BINARY_DIR}/knurlConfig.cmake
                              INSTALL_DESTINATION ${knurl_package_dir} NO_SET_AND_CHECK_MACRO
                              NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/knurlConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/knurlConfig.cmake ${PROJECT_BINARY_DIR}/knurlConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/KnurlDependencies.cmake
        DESTINATION ${knurl_package_dir})

# The way from lib*/pkgconfig (two levels down, or three on Debian's multiarch) up to the prefix.
file(RELATIVE_PATH knurl_pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
# What the client links, users before what they use.
get_property(knurl_pc_libraries GLOBAL PROPERTY KNURL_USES_client)
list(TRANSFORM knurl_pc_libraries PREPEND -lknurl_)
list(JOIN knurl_pc_libraries " " knurl_pc_libraries)
configure_file(${CMAKE_CURRENT_LIST_DIR}/knurl.pc.in ${PROJECT_BINARY_DIR}/knurl.pc @ONLY)
configure_file(${CMAKE_CURRENT_LIST_DIR}/knurl-c.pc.in ${PROJECT_BINARY_DIR}/knurl-c.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/knurl.pc ${PROJECT_BINARY_DIR}/knurl-c.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
