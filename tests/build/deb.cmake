# Run by ctest: makes the .deb and looks into it. -D: BUILD, WORK (scratch).

include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK})
get_filename_component(programs ${CMAKE_COMMAND} DIRECTORY)
run("cpack" ${programs}/cpack -G DEB -B ${WORK} --config ${BUILD}/CPackConfig.cmake)
file(GLOB package ${WORK}/knurl_*.deb)
run("list" dpkg-deb --contents ${package})
foreach(file bin/knurld bin/knurl bin/knurl-bridge bin/knurl-surface bin/knurl-feel bin/knurl-dock lib/systemd/system/knurld.service
             lib/systemd/system/knurl-bridge.service lib/udev/rules.d/70-knurl.rules lib/sysusers.d/knurl.conf
             include/knurl/client/client.hpp)
    if(NOT output MATCHES "\\./usr/${file}\n")
        message(FATAL_ERROR "/usr/${file} is not in the package:\n${output}")
    endif()
endforeach()
run("fields" dpkg-deb --field ${package} Depends)
if(NOT output MATCHES "libc6")
    message(FATAL_ERROR "the package does not know what it depends on: ${output}")
endif()
run("unpack" dpkg-deb --raw-extract ${package} ${WORK}/tree)
foreach(script postinst prerm)
    run("syntax of ${script}" sh -n ${WORK}/tree/DEBIAN/${script})
endforeach()
run("the program in it" ${WORK}/tree/usr/bin/knurld --version)
file(READ ${WORK}/tree/usr/lib/systemd/system/knurld.service unit)
if(NOT unit MATCHES "ExecStart=/usr/bin/knurld --config /etc/knurl/knurld.toml")
    message(FATAL_ERROR "the unit in the package starts something else:\n${unit}")
endif()
