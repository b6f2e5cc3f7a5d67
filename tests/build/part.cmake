# Run by ctest: a project that has Knurl as a part, by FetchContent and by add_subdirectory, configures, would build of it
# what it links and no more, compiles a program with its headers, and is left alone. `scripts/deb-test` links and runs it.
# -D: KNURL (the repository), SOURCE (this folder), WORK (scratch), CXX.

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

find_program(ninja ninja REQUIRED)
file(REMOVE_RECURSE ${WORK})
foreach(fetch ON OFF)
    set(build ${WORK}/fetch-${fetch})
    run("configure, FetchContent ${fetch}" ${CMAKE_COMMAND} -S ${SOURCE}/part -B ${build} -G Ninja -DFETCH=${fetch}
        -DKNURL=${KNURL} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_EXPORT_COMPILE_COMMANDS=ON)
    # What `all` builds: of Knurl what the application links.
    run("ninja" ${ninja} -C ${build} -t commands all)
    if(output MATCHES "knurl_servo|knurl_drivers|-Werror|gtest|knurl-surface" OR NOT output MATCHES "libknurl_client.a")
        message(FATAL_ERROR "the project builds more of Knurl, or less, than it links:\n${output}")
    endif()
    # What is installed: the application alone.
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
# The project's own standard stays for what links nothing of Knurl.
run("compile" ${ninja} -C ${build} libof_17.a CMakeFiles/app.dir/app.cpp.o)
