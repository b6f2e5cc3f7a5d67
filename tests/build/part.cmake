# Run by ctest: a project that includes Knurl, by FetchContent or by add_subdirectory, configures, would build only the
# targets that it links, compiles a program with Knurl's headers, and keeps its own settings. scripts/deb-test runs it.
# -D: KNURL (the repository), SOURCE (this folder), WORK (scratch), CXX.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

find_program(ninja ninja REQUIRED)
file(REMOVE_RECURSE ${WORK})
foreach(fetch ON OFF)
    set(build ${WORK}/fetch-${fetch})
    run("configure, FetchContent ${fetch}" ${CMAKE_COMMAND} -S ${SOURCE}/part -B ${build} -G Ninja -DFETCH=${fetch}
        -DKNURL=${KNURL} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
    # `all` builds only those targets of Knurl that the application links.
    run("ninja" ${ninja} -C ${build} -t commands all)
    if(output MATCHES "knurl_servo|knurl_drivers|-Werror|gtest|knurl-surface" OR NOT output MATCHES "libknurl_client.a")
        message(FATAL_ERROR "the project builds more of Knurl, or less, than it links:\n${output}")
    endif()
    # Only the application is installed.
    file(GLOB_RECURSE scripts ${build}/*/cmake_install.cmake)
    foreach(file IN LISTS scripts)
        file(READ ${file} text)
        if(text MATCHES "file\\(INSTALL")
            message(FATAL_ERROR "Knurl installs files in another's project: ${file}")
        endif()
    endforeach()
    if(EXISTS ${build}/CPackConfig.cmake)
        message(FATAL_ERROR "Knurl packages another's project")
    endif()
endforeach()
# Targets that do not link Knurl keep the project's own C++ standard.
run("compile" ${ninja} -C ${build} libof_17.a CMakeFiles/app.dir/app.cpp.o)
