# Run by ctest: builds the packages and checks their content. -D: BUILD, WORK (scratch), HELP2MAN (its path, or false).

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK})
get_filename_component(programs ${CMAKE_COMMAND} DIRECTORY)
run("cpack" ${programs}/cpack -G DEB -B ${WORK} --config ${BUILD}/CPackConfig.cmake)

# holds(PACKAGE FILE ...): the package has these files under /usr, and its licence.
function(holds package)
    file(GLOB file ${WORK}/${package}_*.deb)
    run("list" dpkg-deb --contents ${file})
    foreach(path share/doc/${package}/copyright ${ARGN})
        if(NOT output MATCHES "\\./usr/${path}\n")
            message(FATAL_ERROR "/usr/${path} is not in ${package}:\n${output}")
        endif()
    endforeach()
    file(MAKE_DIRECTORY ${WORK}/tree)
    run("unpack" dpkg-deb --raw-extract ${file} ${WORK}/tree/${package})
    file(GLOB scripts ${WORK}/tree/${package}/DEBIAN/p*)
    foreach(script IN LISTS scripts)
        run("syntax of ${script}" sh -n ${script})
    endforeach()
    run("fields" dpkg-deb --field ${file} Depends)
    set(depends "${output}" PARENT_SCOPE)
endfunction()

# Man pages, where help2man is installed.
set(server_pages "")
set(tools_pages "")
if(HELP2MAN)
    set(server_pages share/man/man1/knurld.1.gz share/man/man1/knurl-bridge.1.gz share/man/man1/knurl-bridge-keygen.1.gz)
    set(tools_pages share/man/man1/knurl.1.gz share/man/man1/knurl-ls.1.gz share/man/man1/knurl-device-check.1.gz
                    share/man/man1/knurl-feel.1.gz)
endif()
holds(knurl-server ${server_pages} share/bash-completion/completions/knurld share/zsh/vendor-completions/_knurl-bridge bin/knurld bin/knurl-bridge lib/systemd/system/knurld.service lib/systemd/system/knurl-bridge.service
      lib/udev/rules.d/70-knurl.rules lib/sysusers.d/knurl.conf lib/knurl/knurld-stop-post share/knurl/knurld.toml)
if(NOT depends MATCHES "libc6")
    message(FATAL_ERROR "knurl-server does not know what it depends on: ${depends}")
endif()
file(READ ${WORK}/tree/knurl-server/usr/lib/systemd/system/knurld.service unit)
if(NOT unit MATCHES "ExecStart=/usr/bin/knurld --config /etc/knurl/knurld.toml")
    message(FATAL_ERROR "the unit in the package starts something else:\n${unit}")
endif()
run("the program in it" ${WORK}/tree/knurl-server/usr/bin/knurld --version)

holds(knurl-tools ${tools_pages} share/bash-completion/completions/knurl share/zsh/vendor-completions/_knurl bin/knurl bin/knurl-surface bin/knurl-feel bin/knurl-dock bin/knurl-bodies
      share/knurl/scripts/plot_surface.py share/knurl/scripts/pictures.py)
if(NOT depends MATCHES "knurl-server \\(= ")
    message(FATAL_ERROR "knurl-tools takes any server: ${depends}")
endif()

holds(libknurl-dev include/knurl/client/client.hpp share/doc/libknurl-dev/examples/01_wall.cpp)
foreach(package libeigen3-dev libssl-dev nettle-dev libfmt-dev libtomlplusplus-dev libusb-1.0-0-dev)
    if(NOT depends MATCHES "${package}")
        message(FATAL_ERROR "libknurl-dev does not depend on ${package}: ${depends}")
    endif()
endforeach()

# No program names a script that is not installed.
file(GLOB binaries ${WORK}/tree/*/usr/bin/*)
foreach(binary IN LISTS binaries)
    file(STRINGS ${binary} named REGEX "scripts/[a-z]|[a-z_]+\\.py")
    foreach(line IN LISTS named)
        string(REGEX MATCHALL "[a-z_]+\\.py|scripts/[a-z][a-z_.-]*" names "${line}")
        foreach(name IN LISTS names)
            get_filename_component(name ${name} NAME)
            if(NOT EXISTS ${WORK}/tree/knurl-tools/usr/share/knurl/scripts/${name})
                message(FATAL_ERROR "${binary} names ${name}, which is not installed: ${line}")
            endif()
        endforeach()
    endforeach()
endforeach()
