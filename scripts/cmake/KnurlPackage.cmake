# `cpack` in a build folder makes knurl_VERSION_ARCHITECTURE.deb: programs, headers, libraries, the service and the udev
# rules, under /usr.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the makers of Knurl <knurl@localhost>")
set(CPACK_PACKAGE_DESCRIPTION "Owns force-feedback devices and runs their loops at 1 kHz or more; applications describe
 what the hand should feel and read where it is, through shared memory.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libeigen3-dev, libssl-dev")  # whoever builds an application needs them
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/postinst ${CMAKE_CURRENT_LIST_DIR}/deb/prerm)
include(CPack)
