# Run by ctest: installs the build tree, then builds and runs the outside program against it, once found by CMake and
# once by pkg-config. -D: BUILD, SOURCE (this folder), WORK (scratch), CXX, GENERATOR, LIBDIR, FLAGS.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(prefix ${WORK}/prefix)
set(ENV{KNURL_RUNTIME_DIR} ${WORK})

run("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
if(NOT EXISTS ${prefix}/include/knurl/client/client.hpp)
    message(FATAL_ERROR "the client's header is not installed")
endif()

# The service names the program where it lies, and the rules and the group are there.
file(READ ${prefix}/lib/systemd/system/knurld.service unit)
if(NOT unit MATCHES "ExecStart=${prefix}/bin/knurld --config /etc/knurl/knurld.toml")
    message(FATAL_ERROR "the unit starts something else:\n${unit}")
endif()
foreach(file lib/udev/rules.d/70-knurl.rules lib/sysusers.d/knurl.conf share/knurl/knurld.toml bin/knurl-bridge
             lib/systemd/system/knurl-bridge.service)
    if(NOT EXISTS ${prefix}/${file})
        message(FATAL_ERROR "${file} is not installed")
    endif()
endforeach()

run("configure" ${CMAKE_COMMAND} -S ${SOURCE}/outside -B ${WORK}/by-cmake -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DCMAKE_PREFIX_PATH=${prefix})
run("build" ${CMAKE_COMMAND} --build ${WORK}/by-cmake)
run("program found by CMake" ${WORK}/by-cmake/outside)
if(NOT output MATCHES "nobody-listens-here")
    message(FATAL_ERROR "the program did not say which servo is missing:\n${output}")
endif()

set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
run("pkg-config" pkg-config --cflags --libs knurl)
separate_arguments(found UNIX_COMMAND "${FLAGS} ${output}")
run("compile with pkg-config" ${CXX} -std=c++20 ${SOURCE}/outside/main.cpp -o ${WORK}/by-pkg-config ${found})
run("program found by pkg-config" ${WORK}/by-pkg-config)

# An application links the client alone: no TOML, no libusb, nothing of the servo.
find_program(readelf readelf REQUIRED)
run("readelf" ${readelf} -d ${WORK}/by-pkg-config)
if(output MATCHES "tomlplusplus|libusb|libfmt|boost")
    message(FATAL_ERROR "an application needs a library of the servo's:\n${output}")
endif()
