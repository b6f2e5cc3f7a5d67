# Run by ctest: installs the build tree, then builds and runs programs against it, found by CMake and by pkg-config.
# -D: BUILD, SOURCE (this folder), WORK (scratch), CXX, GENERATOR, LIBDIR, FLAGS.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(prefix ${WORK}/prefix)
set(ENV{KNURL_RUNTIME_DIR} ${WORK})
set(ENV{KNURL_STATE_DIR} ${WORK}/state)

run("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
if(NOT EXISTS ${prefix}/include/knurl/client/client.hpp)
    message(FATAL_ERROR "the client's header is not installed")
endif()

# The service has the installed path of the program, and the udev rules and the group are installed.
file(READ ${prefix}/lib/systemd/system/knurld.service unit)
if(NOT unit MATCHES "ExecStart=${prefix}/bin/knurld --config /etc/knurl/knurld.toml")
    message(FATAL_ERROR "the unit starts something else:\n${unit}")
endif()
if(NOT unit MATCHES "ExecStopPost=-${prefix}/lib/knurl/knurld-stop-post")
    message(FATAL_ERROR "the unit waits for no guardian:\n${unit}")
endif()
foreach(file lib/udev/rules.d/70-knurl.rules lib/sysusers.d/knurl.conf share/knurl/knurld.toml bin/knurl-bridge
             lib/systemd/system/knurl-bridge.service lib/knurl/knurld-stop-post)
    if(NOT EXISTS ${prefix}/${file})
        message(FATAL_ERROR "${file} is not installed")
    endif()
endforeach()

# Every module, by find_package(knurl REQUIRED) and as the only component. The tree is moved first, to show that it can be
# found at any place.
file(RENAME ${prefix} ${WORK}/moved)
set(prefix ${WORK}/moved)
set(by_cmake ${WORK}/by-cmake)
run("configure" ${CMAKE_COMMAND} -S ${SOURCE}/outside -B ${by_cmake} -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DCMAKE_PREFIX_PATH=${prefix})
run("build" ${CMAKE_COMMAND} --build ${by_cmake})
file(GLOB programs ${by_cmake}/bin/*)
foreach(program IN LISTS programs)
    run("${program}" ${program})
endforeach()
run("the client" ${by_cmake}/bin/client_alone)
if(NOT output MATCHES "nobody-listens-here")
    message(FATAL_ERROR "the program did not say which servo is missing:\n${output}")
endif()

# A request that cannot be met is refused, with the name of what is missing.
function(refused with components what)
    file(WRITE ${WORK}/refused/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\n${with}\n"
                                              "find_package(knurl REQUIRED ${components})\n")
    execute_process(COMMAND ${CMAKE_COMMAND} -S ${WORK}/refused -B ${WORK}/refused/build -G ${GENERATOR}
                            -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${prefix}
                    RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE errors)
    file(REMOVE_RECURSE ${WORK}/refused)
    string(REGEX REPLACE "[ \n]+" " " errors "${errors}")
    if(result EQUAL 0 OR NOT errors MATCHES "${what}")
        message(FATAL_ERROR "not refused with \"${what}\": find_package(knurl ${components}) ${with}:\n${errors}")
    endif()
endfunction()
refused("" "COMPONENTS clent" "knurl has no component clent; it has .*client")
refused("set(CMAKE_DISABLE_FIND_PACKAGE_fmt ON)" "COMPONENTS servo" "knurl::servo needs fmt, .*libfmt-dev")
refused("set(CMAKE_DISABLE_FIND_PACKAGE_OpenSSL ON)" "" "knurl::client needs OpenSSL, .*libssl-dev")

# Builds and runs the programs of the READMEs, with the README's CMakeLists.txt, beside a servo.
set(README ${WORK}/readme)
run("readme.py" ${SOURCE}/readme.py extract ${README})
file(GLOB programs ${README}/program_*.cpp)
if(NOT programs)
    message(FATAL_ERROR "the READMEs show no program")
endif()
foreach(source IN LISTS programs)
    file(WRITE ${WORK}/simulation/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(simulation LANGUAGES CXX)\n"
                                                 "add_executable(my_simulation ${source})\ninclude(${README}/my_simulation.cmake)\n")
    run("configure" ${CMAKE_COMMAND} -S ${WORK}/simulation -B ${WORK}/simulation/build -G ${GENERATOR}
        -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}" -DCMAKE_PREFIX_PATH=${prefix})
    run("build" ${CMAKE_COMMAND} --build ${WORK}/simulation/build)
    # One command a line, since CMake would end the argument at a semicolon.
    run("${source}" sh -c "${prefix}/bin/knurld --device right=sim:premium15 >/dev/null 2>&1 &
        servo=$!
        ${WORK}/simulation/build/my_simulation
        code=$?
        kill $servo
        wait $servo
        exit $code")
    if(NOT output MATCHES "mm, [0-9.]*[1-9][0-9]* N")
        message(FATAL_ERROR "the README's program felt nothing:\n${output}")
    endif()
    file(REMOVE_RECURSE ${WORK}/simulation)
endforeach()

# With pkg-config, and once more static, with the libraries that --static names.
set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
run("pkg-config" pkg-config --cflags --libs knurl)
separate_arguments(found UNIX_COMMAND "${FLAGS} ${output}")
run("compile with pkg-config" ${CXX} -std=c++20 ${SOURCE}/outside/modules/client.cpp -o ${WORK}/by-pkg-config ${found})
run("program found by pkg-config" ${WORK}/by-pkg-config)
run("pkg-config --static" pkg-config --static --libs knurl)
separate_arguments(found UNIX_COMMAND "${FLAGS} ${output}")
file(GLOB_RECURSE object ${by_cmake}/all/CMakeFiles/client.dir/*.o)
run("link with pkg-config --static" ${CXX} ${object} -o ${WORK}/by-pkg-config-static ${found})

# An application links only the client: no TOML, no libusb, nothing of the servo.
find_program(readelf readelf REQUIRED)
run("readelf" ${readelf} -d ${WORK}/by-pkg-config ${by_cmake}/bin/client_of_all)
if(output MATCHES "tomlplusplus|libusb|libfmt|boost")
    message(FATAL_ERROR "an application needs a library of the servo's:\n${output}")
endif()
