# `cpack` in a build folder makes seven packages of Debian's, under /usr:
#   libknurl0          the client for C and what calls C
#   libknurl-offline0  the servo's cycle in a process of one's own, likewise
#   python3-knurl      the same for Python
#   libknurl-dev   headers, static libraries, find_package and pkg-config, examples
#   knurl-server   knurld, knurl-bridge, knurl-device, their units, the udev rules, user and group, arms
#   knurl-dds      knurl-dds, where it is built: it alone needs a DDS
#   knurl-tools    knurl, knurl-web, knurl-vrpn, and the demonstration programs with the scripts that draw what they measured
#   knurl-lookalikes   libraries with the names of vendors' libraries, for `knurl as`: apart, so that who has the vendors' is not given ours
# A component of the installation is a package; each thing says where it is installed to which it belongs.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "the makers of Knurl <knurl@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package's own is the first line of its description
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL libknurl-dev libknurl0 libknurl-offline0 python3-knurl knurl-server knurl-tools knurl-lookalikes)
if(TARGET knurl-dds)
    list(APPEND CPACK_COMPONENTS_ALL knurl-dds)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
foreach(package LIBKNURL-DEV LIBKNURL0 LIBKNURL-OFFLINE0 PYTHON3-KNURL KNURL-SERVER KNURL-TOOLS KNURL-LOOKALIKES KNURL-DDS)
    string(TOLOWER ${package} CPACK_DEBIAN_${package}_PACKAGE_NAME)
    set(CPACK_DEBIAN_${package}_PACKAGE_SECTION science)
    # All was one package once.
    set(CPACK_DEBIAN_${package}_PACKAGE_CONFLICTS knurl)
    set(CPACK_DEBIAN_${package}_PACKAGE_REPLACES knurl)
endforeach()

# Whoever builds an application needs what the libraries are linked with: all of it, so that every module can be found.
set(knurl_depends "")
get_property(knurl_package_modules GLOBAL PROPERTY KNURL_MODULES)
foreach(module IN LISTS knurl_package_modules)
    get_property(needs GLOBAL PROPERTY KNURL_NEEDS_${module})
    foreach(package IN LISTS needs)
        list(APPEND knurl_depends ${knurl_debian_${package}})
    endforeach()
endforeach()
list(REMOVE_DUPLICATES knurl_depends)
list(APPEND knurl_depends "libknurl0 (= ${PROJECT_VERSION})" "libknurl-offline0 (= ${PROJECT_VERSION})")
list(JOIN knurl_depends ", " CPACK_DEBIAN_LIBKNURL-DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_LIBKNURL-DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBKNURL-DEV_PACKAGE_SUGGESTS "cmake, g++ (>= 4:12), knurl-server (= ${PROJECT_VERSION}), pkg-config")
set(CPACK_DEBIAN_LIBKNURL-DEV_DESCRIPTION "haptics server for Linux - client library
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has the library that an application links (C++20), those that the
server is made of, and the headers of the libraries for C.")

foreach(package LIBKNURL0 LIBKNURL-OFFLINE0)
    set(CPACK_DEBIAN_${package}_PACKAGE_SECTION libs)
    # Its one script calls ldconfig, as a trigger.
    file(WRITE ${PROJECT_BINARY_DIR}/deb/triggers "activate-noawait ldconfig\n")
    set(CPACK_DEBIAN_${package}_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/deb/triggers)
endforeach()
set(CPACK_DEBIAN_LIBKNURL0_PACKAGE_SUGGESTS knurl-server)
set(CPACK_DEBIAN_LIBKNURL0_DESCRIPTION "haptics server for Linux - client library for C
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has the library by which programs in C, and in languages that call
C, do so.")
set(CPACK_DEBIAN_LIBKNURL-OFFLINE0_DESCRIPTION "haptics server for Linux - the loop without a server
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has the loop as a library on a virtual clock, for tests, plots and
programs that learn.")

set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/python3-knurl/postinst
    ${CMAKE_CURRENT_LIST_DIR}/deb/python3-knurl/prerm)
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_DEPENDS
    "libknurl0 (= ${PROJECT_VERSION}), python3 (>= 3.9), python3-numpy")
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_RECOMMENDS "knurl-server (= ${PROJECT_VERSION}), libknurl-offline0 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON3-KNURL_PACKAGE_SUGGESTS "python3-matplotlib, python3-pil")
set(CPACK_DEBIAN_PYTHON3-KNURL_DESCRIPTION "haptics server for Linux - Python
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has the module knurl, by which Python programs do so.")

set(CPACK_DEBIAN_KNURL-SERVER_PACKAGE_DEPENDS passwd)
set(CPACK_DEBIAN_KNURL-SERVER_PACKAGE_SUGGESTS knurl-tools)
set(CPACK_DEBIAN_KNURL-SERVER_DESCRIPTION "haptics server for Linux - server
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has the server, the bridge that lets applications on other hosts
use it, services for both (which are not enabled by themselves), and rules that
give the group haptics the devices.")

# They start servers of their own, and a server of another build refuses them.
set(CPACK_DEBIAN_KNURL-TOOLS_PACKAGE_DEPENDS "knurl-server (= ${PROJECT_VERSION}), python3")
set(CPACK_DEBIAN_KNURL-TOOLS_PACKAGE_SUGGESTS "knurl-lookalikes, python3-matplotlib, python3-numpy, python3-pil")
set(CPACK_DEBIAN_KNURL-TOOLS_DESCRIPTION "haptics server for Linux - tools
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has knurl, which lists, records, replays, measures and tests
servers and devices, knurl-web, which shows them in a browser, knurl-vrpn,
which serves them to programs that speak VRPN, and programs
that put a relief, a mesh, an atom of a running simulation or rigid bodies in
the hand.")

# They speak to a server of the same build, and `knurl as` finds them.
set(CPACK_DEBIAN_KNURL-LOOKALIKES_PACKAGE_DEPENDS "knurl-tools (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_KNURL-LOOKALIKES_DESCRIPTION "haptics server for Linux - programs for other libraries
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has libraries with the functions of Force Dimension's libdhd and
libdrd and of OpenHaptics' libHD, by which programs that were written for those
run on Knurl's devices: knurl as dhd -- program. It has no code of these makers.")

# It reads the servo's memory, and a server of another build refuses it.
set(CPACK_DEBIAN_KNURL-DDS_PACKAGE_DEPENDS "knurl-server (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_KNURL-DDS_PACKAGE_SUGGESTS knurl-tools)
set(CPACK_DEBIAN_KNURL-DDS_DESCRIPTION "haptics server for Linux - DDS and ROS 2
Knurl owns force-feedback devices and runs their loops at 1 kHz or more;
applications describe what the hand should feel and read where it is, through
shared memory.

This package has knurl-dds, which shows devices to robots as topics of ROS 2,
takes their commands, and lets the servos of many hosts find each other.")

set(CPACK_DEBIAN_KNURL-SERVER_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/deb/knurl-server/postinst
    ${CMAKE_CURRENT_LIST_DIR}/deb/knurl-server/prerm ${CMAKE_CURRENT_LIST_DIR}/deb/knurl-server/postrm)

# What Debian asks of every package; left out by `cmake --install`.
file(READ ${PROJECT_SOURCE_DIR}/LICENSE knurl_licence)
string(STRIP "${knurl_licence}" knurl_licence)
string(REPLACE "\n\n" "\n.\n" knurl_licence "${knurl_licence}")
string(REPLACE "\n" "\n " knurl_licence " ${knurl_licence}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/deb/copyright.in ${PROJECT_BINARY_DIR}/deb/copyright @ONLY)
string(TIMESTAMP knurl_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
find_program(KNURL_GZIP gzip)
foreach(package IN LISTS CPACK_COMPONENTS_ALL)
    set(folder ${PROJECT_BINARY_DIR}/deb/${package})
    file(WRITE ${folder}/changelog "${package} (${PROJECT_VERSION}) unstable; urgency=medium\n
  * What is new: CHANGELOG.md, beside this file in knurl-server.\n\n -- ${CPACK_PACKAGE_CONTACT}  ${knurl_date}\n")
    if(KNURL_GZIP)
        execute_process(COMMAND ${KNURL_GZIP} -9nf ${folder}/changelog)
        install(FILES ${folder}/changelog.gz DESTINATION share/doc/${package} COMPONENT ${package} EXCLUDE_FROM_ALL)
    endif()
    install(FILES ${PROJECT_BINARY_DIR}/deb/copyright DESTINATION share/doc/${package} COMPONENT ${package} EXCLUDE_FROM_ALL)
    install(FILES ${CMAKE_CURRENT_LIST_DIR}/deb/${package}/overrides DESTINATION share/lintian/overrides RENAME ${package}
            COMPONENT ${package} EXCLUDE_FROM_ALL)
endforeach()
install(FILES ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${PROJECT_SOURCE_DIR}/README.md DESTINATION share/doc/knurl-server
        COMPONENT knurl-server EXCLUDE_FROM_ALL)
include(CPack)
