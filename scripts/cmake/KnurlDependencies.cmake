# The packages of others that Knurl's libraries are linked with: how each is found, once, for the build, for
# find_package(knurl) (this file is installed beside knurlConfig.cmake) and for the Debian package.

set(knurl_debian_Threads libc6-dev)
set(knurl_debian_Eigen3 libeigen3-dev)
set(knurl_debian_OpenSSL libssl-dev)
set(knurl_debian_fmt libfmt-dev)
set(knurl_debian_tomlplusplus libtomlplusplus-dev)
set(knurl_debian_Nettle nettle-dev)
set(knurl_debian_Usb libusb-1.0-0-dev)
# Of the program knurl-dds alone, which is left out without it.
set(knurl_debian_CycloneDDS "cyclonedds-dev and cyclonedds-tools")

# knurl::nettle, knurl::usb: libraries that bring no CMake files of their own.
function(knurl_find_library package header library)
    find_path(KNURL_${package}_INCLUDE_DIR ${header} PATH_SUFFIXES libusb-1.0)
    find_library(KNURL_${package}_LIBRARY ${library})
    mark_as_advanced(KNURL_${package}_INCLUDE_DIR KNURL_${package}_LIBRARY)
    set(${package}_FOUND FALSE PARENT_SCOPE)
    if(NOT KNURL_${package}_INCLUDE_DIR OR NOT KNURL_${package}_LIBRARY)
        return()
    endif()
    set(${package}_FOUND TRUE PARENT_SCOPE)
    string(TOLOWER ${package} name)
    if(NOT TARGET knurl::${name})
        if(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL)
            add_library(knurl::${name} UNKNOWN IMPORTED GLOBAL)
        else()
            add_library(knurl::${name} UNKNOWN IMPORTED)
        endif()
        set_target_properties(knurl::${name} PROPERTIES IMPORTED_LOCATION "${KNURL_${package}_LIBRARY}"
                              INTERFACE_INCLUDE_DIRECTORIES "${KNURL_${package}_INCLUDE_DIR}")
    endif()
endfunction()

# Leaves <package>_FOUND.
macro(knurl_find_package package)
    if("${package}" STREQUAL Eigen3)
        find_package(Eigen3 3.4 QUIET NO_MODULE)
    elseif("${package}" STREQUAL OpenSSL)
        find_package(OpenSSL 3.0 QUIET)
    elseif("${package}" STREQUAL Nettle)
        knurl_find_library(Nettle nettle/sha2.h nettle)
    elseif("${package}" STREQUAL Usb)
        knurl_find_library(Usb libusb.h usb-1.0)
    else()
        find_package(${package} QUIET)
    endif()
endmacro()
